"""Where samples come from: a file, or arrays."""
from __future__ import annotations

import functools
import json
import os
import weakref
from typing import Union

import numpy as np

from . import _core, reader
from .arguments import array, choice, flag, image_size, note_axes, option_text, text, whole, wrong
from .arguments import path as path_of
from .cells import recording_html
from .error import SpoolError
from .record_layout import MAX_SPP
from .save import check_reference
from .scratch import scratch_folder

FEATURES = {"albedo": "RGB", "normal": "XYZ", "depth": "Z"}


class Dump(reader.Dump):
    """A file, read by numpy (read, pixel, passes, block) and, for replays, mapped by the library."""

    def __init__(self, path):
        super().__init__(path)
        self.source = _core.Source(os.path.abspath(self.path), *self._records.file_id)

    def _repr_html_(self):
        return recording_html(self, json.loads(_core.recording_facts(self.source.path())),
                              self.pixel("reference") if "reference" in self.layers else None)


def open(path: str | os.PathLike) -> Dump:
    """Opens a complete `.spool` file."""
    dump = Dump(path_of("path", path))
    if dump.path.endswith(".partial"):
        dump.close()
        return reader.open(path)  # which says what is wrong with it
    return dump


def example() -> Dump:
    """The recording of the package: 64 x 64 pixels of a Cornell box, 16 samples each, with features and reference."""
    return open(os.path.join(os.path.dirname(__file__), "example.spool"))


class Recording:
    """Samples in memory. `arrays` are copies of those it was made of, by name, as spool.write takes them."""

    def __init__(self, source, arrays, sample_order):
        self.source, self.arrays, self.sample_order = source, arrays, sample_order
        self.height, self.width, self.spp = arrays["radiance"].shape[:3]

    def __reduce__(self):  # all of its arrays
        return functools.partial(recording, name=self.source.name, sample_order=self.sample_order, **self.arrays), ()

    def __repr__(self):
        return f"<spool.Recording {self.source.name}: {self.width} x {self.height} pixels, {self.spp} samples each>"

    def _repr_html_(self):
        facts = [["samples in memory", self.source.name], ["image", f"{self.width} x {self.height} pixels"],
                 ["samples", f"{self.spp} per pixel, {self.sample_order}"], ["arrays", ", ".join(self.arrays)],
                 ["verified", "no: write it, and dumps/verify/verify.py FILE --write tests the samples"]]
        return recording_html(self, facts, self.arrays.get("reference"))


Samples = Union[Dump, Recording, str, os.PathLike, np.ndarray]  # what replay and reconstruct take


def recording(radiance: np.ndarray, *, film: np.ndarray | None = None, albedo: np.ndarray | None = None,
              normal: np.ndarray | None = None, depth: np.ndarray | None = None, reference: np.ndarray | None = None,
              reference_variance: np.ndarray | None = None, sample_order: str = "exchangeable",
              name: str = "recording") -> Recording:
    """Samples that lie in memory, radiance [y][x][s][3], as something to replay.

    `film` [y][x][s][2] are positions inside the pixel, `albedo`, `normal` [y][x][s][3] and `depth` [y][x][s] features,
    `reference` and `reference_variance` [y][x][3] what images are judged by. All are copied: what is written into them
    later does not reach the recording.
    """
    given = {"radiance": radiance, "film": film, "albedo": albedo, "normal": normal, "depth": depth,
             "reference": reference, "reference_variance": reference_variance}
    if os.path.basename(text("name", name)) != name or name in ("", ".", ".."):
        raise SpoolError("usage", f"name {name!r}: is no name of a file")
    if isinstance(radiance, (str, os.PathLike)):
        raise wrong(f"{name}: radiance", radiance, "no array: spool.open reads a file")
    choice("sample_order", sample_order, ("exchangeable", "renderer"))
    arrays = {key: array(f"{name}: {key}", values, "f") for key, values in given.items()
              if values is not None or key == "radiance"}
    shape = arrays["radiance"].shape
    if len(shape) != 4 or shape[3] != 3 or not 0 < shape[2] <= MAX_SPP:
        raise SpoolError("usage", f"{name}: radiance has shape {shape}, not (height, width, spp, 3) with 1 to {MAX_SPP} samples")
    image_size(f"{name}: radiance", shape)
    note_axes(name, arrays)
    for key, channels in (("film", 2), ("albedo", 3), ("normal", 3), ("depth", 1)):
        if key in arrays:
            arrays[key] = arrays[key].reshape(*shape[:3], 1) if arrays[key].shape == shape[:3] else arrays[key]
            _want_shape(name, key, arrays[key], (*shape[:3], channels))
    for key in ("reference", "reference_variance"):
        if key in arrays:
            _want_shape(name, key, arrays[key], (*shape[:2], 3))
    check_reference(name, arrays)
    held = {key: _frozen(values, np.float64, key) if key.startswith("reference") else _planes(values, key) for key, values in arrays.items()}
    source = _core.Source(name, held["radiance"], held.get("film"),
                          [(key, components, held[key]) for key, components in FEATURES.items() if key in held],
                          held.get("reference"), held.get("reference_variance"), sample_order == "exchangeable")
    return Recording(source, {key: values if key.startswith("reference") else np.moveaxis(values, 0, 3)
                              for key, values in held.items()}, sample_order)


def recording_of(samples: Samples) -> Dump | Recording:
    """Paths are opened, arrays become Recordings."""
    if isinstance(samples, (Dump, Recording)):
        return samples
    if isinstance(samples, (str, os.PathLike)):
        return open(samples)
    return recording(array("samples", samples))


def synth(scene: str, *, width: int = 128, height: int = 128, spp: int = 64, seed: int = 1,
          path: str | os.PathLike | None = None, compress: bool = False, force: bool = False, **options) -> Dump:
    """An analytic scene, sampled, with its exact reference. Without a path the file goes with the Recording."""
    sizes = whole("width", width), whole("height", height), whole("spp", spp), whole("seed", seed, 64)
    image_size("synth", (height, width))
    folder = None if path is not None else scratch_folder()
    place = os.path.join(folder.name, "synth.spool") if folder else text("path", path_of("path", path))
    _core.synth(text("scene", scene), *sizes, place, [f"{key}={option_text(value)}" for key, value in options.items()],
                flag("compress", compress), flag("force", force))
    dump = open(place)
    if folder:
        weakref.finalize(dump, folder.cleanup)
    return dump


def _planes(values, key):
    """A copy [c][y][x][s] that no other code writes to."""
    planes = _frozen(np.moveaxis(values, 3, 0), np.float32, key)
    if values.dtype.kind == "f" and values.dtype.itemsize > 4:
        given = np.moveaxis(values, 3, 0)
        lost = np.isinf(planes) & np.isfinite(given)
        if lost.any():
            raise SpoolError("data", f"{key}: {given[lost][0]} is too large for float32: scale the samples")
    return planes


def _frozen(values, kind, key):
    try:
        with np.errstate(over="ignore"):  # what becomes infinite is left out as such
            copy = np.array(values, kind, order="C", copy=True)
    except MemoryError:
        raise SpoolError("io", f"{key}: {values.size} values are more than memory holds: write a file part by part (spool.Writer)") from None
    copy.flags.writeable = False
    return copy


def _want_shape(name, key, array, shape):
    if array.shape != shape:
        raise SpoolError("usage", f"{name}: {key} has shape {array.shape}, not {shape}")
