"""Reader and writer of `.spool` sample records in numpy, written from formats/spool.md alone.

    import spool
    with spool.open("scene.spool") as dump:
        mean = dump.read("radiance").mean(axis=2)          # [y][x][s][c] -> [y][x][c]

    spool.write("mine.spool", radiance=samples, meta={"renderer": {"name": "mine"}})

Every failure is a SpoolError with one line of text and the exit code of the program `spool`.
"""
from .append import append_meta
from .channel import Channel, Layer
from .check import Report, check
from .error import DAMAGE, DATA, IO, USAGE, SpoolError
from .reader import Dump, open  # noqa: A004 - spool.open is the name a user expects
from .save import write
from .writer import Writer

__all__ = ["Channel", "DAMAGE", "DATA", "Dump", "IO", "Layer", "Report", "SpoolError", "USAGE",
           "Writer", "append_meta", "check", "open", "write"]
__version__ = "0.1.0"
