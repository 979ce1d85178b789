"""Where samples come from: a file, or arrays."""
from __future__ import annotations

import os
import tempfile
import weakref
from typing import Union

import numpy as np

from . import _core, reader
from .error import SpoolError

FEATURES = {"albedo": "RGB", "normal": "XYZ", "depth": "Z"}


class Dump(reader.Dump):
    """A file, read by numpy (read, pixel, passes, block) and, for replays, mapped by the library."""

    def __init__(self, path):
        super().__init__(path)
        self.source = _core.Source(os.path.abspath(self.path))

    def __repr__(self):
        return (f"<spool.Dump {self.path}: {self.width} x {self.height} pixels, {self.spp} samples each, "
                f"{', '.join(self.layers)}>")


def open(path: str | os.PathLike) -> Dump:
    """Opens a complete `.spool` file."""
    dump = Dump(path)
    if dump.path.endswith(".partial"):
        dump.close()
        return reader.open(path)  # which says what is wrong with it
    return dump


class Recording:
    """Samples in memory. `arrays` are those it was made of, by name, as spool.write takes them."""

    def __init__(self, source, arrays, sample_order):
        self.source, self.arrays, self.sample_order = source, arrays, sample_order
        self.height, self.width, self.spp = arrays["radiance"].shape[:3]

    def __repr__(self):
        return f"<spool.Recording {self.source.name}: {self.width} x {self.height} pixels, {self.spp} samples each>"


Samples = Union[Dump, Recording, str, os.PathLike, np.ndarray]  # what replay and reconstruct take


def recording(radiance: np.ndarray, *, film: np.ndarray | None = None, albedo: np.ndarray | None = None,
              normal: np.ndarray | None = None, depth: np.ndarray | None = None, reference: np.ndarray | None = None,
              reference_variance: np.ndarray | None = None, sample_order: str = "exchangeable",
              name: str = "recording") -> Recording:
    """Samples that lie in memory, radiance [y][x][s][3], as something to replay.

    `film` [y][x][s][2] are positions inside the pixel, `albedo`, `normal` [y][x][s][3] and `depth` [y][x][s] features,
    `reference` and `reference_variance` [y][x][3] what images are judged by. An array of float32 that lies in memory as
    [c][y][x][s] (np.moveaxis of such a one) is not copied.
    """
    given = {"radiance": radiance, "film": film, "albedo": albedo, "normal": normal, "depth": depth,
             "reference": reference, "reference_variance": reference_variance}
    arrays = {key: np.asarray(array) for key, array in given.items() if array is not None}
    shape = arrays["radiance"].shape
    if len(shape) != 4 or shape[3] != 3 or 0 in shape:
        raise SpoolError("usage", f"{name}: radiance has shape {shape}, not (height, width, spp, 3)")
    for key, channels in (("film", 2), ("albedo", 3), ("normal", 3), ("depth", 1)):
        if key in arrays:
            arrays[key] = arrays[key].reshape(*shape[:3], 1) if arrays[key].shape == shape[:3] else arrays[key]
            _want_shape(name, key, arrays[key], (*shape[:3], channels))
    for key in ("reference", "reference_variance"):
        if key in arrays:
            _want_shape(name, key, arrays[key], (*shape[:2], 3))
    features = [(key, components, _planes(arrays[key], key)) for key, components in FEATURES.items() if key in arrays]
    source = _core.Source(name, _planes(arrays["radiance"], "radiance"), _planes(arrays["film"], "film") if "film" in arrays else None,
                          features, _image(arrays.get("reference")), _image(arrays.get("reference_variance")),
                          sample_order == "exchangeable")
    return Recording(source, arrays, sample_order)


def recording_of(samples: Samples) -> Dump | Recording:
    """Paths are opened, arrays become Recordings."""
    if isinstance(samples, (Dump, Recording)):
        return samples
    if isinstance(samples, (str, os.PathLike)):
        return open(samples)
    return recording(samples)


def synth(scene: str, *, width: int = 128, height: int = 128, spp: int = 64, seed: int = 1,
          path: str | os.PathLike | None = None, compress: bool = False, force: bool = False, **options) -> Dump:
    """An analytic scene, sampled, with its exact reference. Without a path the file goes with the Dump."""
    folder = None if path else tempfile.TemporaryDirectory(prefix="spool-")
    place = os.path.join(folder.name, f"{scene}.spool") if folder else os.fspath(path)
    _core.synth(scene, width, height, spp, seed, place, [(key, option_text(value)) for key, value in options.items()],
                compress, force)
    dump = open(place)
    if folder:
        weakref.finalize(dump, folder.cleanup)
    return dump


def option_text(value):
    """An option as it is written on a command line."""
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, np.generic):
        value = value.item()
    return repr(value) if isinstance(value, float) else str(value)


def _planes(array, key):
    with np.errstate(over="ignore"):
        planes = np.ascontiguousarray(np.moveaxis(array, 3, 0), np.float32)
    if array.dtype.kind == "f" and array.dtype.itemsize > 4:
        lost = np.isinf(planes) & np.isfinite(np.moveaxis(array, 3, 0))
        if lost.any():
            raise SpoolError("data", f"{key}: {np.moveaxis(array, 3, 0)[lost][0]} is too large for float32: scale the samples")
    return planes


def _image(array):
    return None if array is None else np.ascontiguousarray(array, np.float64)


def _want_shape(name, key, array, shape):
    if array.shape != shape:
        raise SpoolError("usage", f"{name}: {key} has shape {array.shape}, not {shape}")
