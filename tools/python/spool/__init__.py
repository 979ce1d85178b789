"""Spool in Python: recordings of single samples, adaptive samplers replayed on them, filters, errors.

    import spool
    dump = spool.open("chess.spool")
    selection = spool.replay(dump, "multiscale", spp=8)
    image = spool.reconstruct(dump, selection, "directional")
    print(spool.metrics(image, dump.pixel("reference"))["relmse"])

The same functions as the program `spool`, the same bits. Every failure is a SpoolError with the line that the program
prints and its exit code. Readers and writers of the file format are those of formats/python.
"""
from ._core import version as __version__  # noqa: F401
from .append import append_meta
from .channel import Channel, Layer
from .check import Report, check
from .error import DAMAGE, DATA, IO, USAGE, SpoolError
from .evaluation import Results, evaluate, results
from .images import Image, metrics
from .own_methods import Method, Statistics, filter, sampler  # noqa: A004 - read as spool.filter
from .recordings import Dump, Recording, example, open, recording, synth  # noqa: A004 - spool.open is the name a user expects
from .save import write
from .showing import Page, show, view
from .steps import Reconstruction, Selection, filters, reconstruct, replay, samplers
from .writer import Writer

__all__ = ["Channel", "DAMAGE", "DATA", "Dump", "IO", "Image", "Layer", "Method", "Page", "Reconstruction", "Recording", "Report",
           "Results", "Selection", "SpoolError", "Statistics", "USAGE", "Writer", "append_meta", "check", "evaluate", "example", "filter", "filters", "metrics",
           "open", "reconstruct", "recording", "replay", "results", "sampler", "samplers", "show", "synth", "view", "write"]
