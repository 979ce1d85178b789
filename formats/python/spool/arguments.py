"""What a function was handed, as what it needs, or a SpoolError in one line. Bounds of numbers are the library's matter."""
from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping

import numpy as np

from .error import SpoolError
from .record_layout import MAX_PIXELS, MAX_SIDE


def whole(name: str, value, bits: int = 32) -> int:
    """A whole number that a number of the library holds."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise wrong(name, value, "no whole number")
    if not -2 ** (bits - 1) <= value < 2 ** (bits - 1):
        raise wrong(name, value, "too large a number")
    return int(value)


def number(name: str, value) -> float:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise wrong(name, value, "no number")
    try:
        return float(value)
    except OverflowError:
        raise wrong(name, value, "too large a number") from None


def flag(name: str, value) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise wrong(name, value, "neither True nor False")
    return bool(value)


def text(name: str, value) -> str:
    """A text that the library can be handed: UTF-8, without NUL."""
    if not isinstance(value, str):
        raise wrong(name, value, "no text")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise wrong(name, value, "no text that can be written") from None
    if "\0" in value:
        raise wrong(name, value, "no text: it holds a NUL")
    return str(value)


def texts(name: str, values) -> list[str]:
    """Several, or one."""
    if isinstance(values, str):
        return [text(name, values)]
    if not isinstance(values, Iterable) or isinstance(values, (bytes, Mapping, np.ndarray)):
        raise wrong(name, values, "no list of texts")
    return [text(name, value) for value in values]


def path(name: str, value) -> str:
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if not isinstance(value, str) or not value:
        raise wrong(name, value, "no path")
    if "\0" in value:
        raise wrong(name, value, "no path: it holds a NUL")
    return value


def absolute(value: str) -> str:
    try:
        return os.path.abspath(value)
    except OSError:  # it is looked up for a relative path alone
        raise SpoolError("io", f"{value}: the working directory is gone: change to another, or give a path from the root") from None


def mapping(name: str, value) -> dict[str, object]:
    if not isinstance(value, Mapping):
        raise wrong(name, value, "no dict")
    return {text(f"{name}: key", key): value[key] for key in value}


def choice(name: str, value, allowed) -> str:
    if text(name, value) not in allowed:
        raise wrong(name, value, f"not one of {', '.join(allowed)}")
    return value


def array(name: str, value, kinds: str = "fiu") -> np.ndarray:
    """An array of ordinary numbers; of light and the like ("f"), whole ones are a picture's bytes."""
    unmasked(name, value)
    if isinstance(value, (str, bytes)):
        raise wrong(name, value, "no array")
    made = plain(name, value)
    if made.dtype.kind == "O":
        raise SpoolError("usage", f"{name}: is {type(value).__name__}, no array of numbers")
    if made.dtype.kind not in kinds:
        instead = "floats: decode it, v / 255 or as it was encoded, and linearise what is sRGB" if kinds == "f" else "numbers"
        raise SpoolError("usage", f"{name}: holds {_short(made.dtype)}, not {instead}")
    return made


def plain(name: str, value) -> np.ndarray:
    """What numpy makes of it; a tensor on another device, or with a gradient, has words of its own against that."""
    try:
        return np.asarray(value)
    except Exception as reason:  # noqa: BLE001 - whatever its __array__ raises
        raise SpoolError("usage", f"{name}: is no array: {reason}") from reason


def unmasked(name: str, value) -> None:
    """A mask would be ignored, so it is refused."""
    if isinstance(value, np.ma.MaskedArray):
        raise SpoolError("usage", f"{name}: is a masked array, and masks are not looked at: hand over .filled(VALUE)")


def image_size(name: str, shape) -> None:
    """Of an array [y][x]...: before it is copied, since an array of stride 0 has any size."""
    height, width = shape[:2]
    if not (0 < height <= MAX_SIDE and 0 < width <= MAX_SIDE and height * width <= MAX_PIXELS):
        raise SpoolError("usage", f"{name}: {width} x {height} pixels: give 1 to {MAX_SIDE} on a side, and at most {MAX_PIXELS} in all")


def note_axes(name: str, arrays: Mapping) -> None:
    """More samples than rows and columns is rare; an array [sample][y][x] is read like that without an error."""
    height, width, spp = arrays["radiance"].shape[:3]
    if spp > height and 2 * spp >= width and "reference" not in arrays:  # which has the image's own shape
        warnings.warn(f"{name}: read as {width} x {height} pixels of {spp} samples, [y][x][sample][channel]; of [sample][y][x][channel] "
                      "give numpy.moveaxis(array, 0, 2)", stacklevel=3)


def option_text(value) -> str:
    """An option as it is written on a command line."""
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, np.generic):
        value = value.item()
    return repr(float(value)) if isinstance(value, float) else text("option", str(value))


def wrong(name: str, value, what: str) -> SpoolError:
    return SpoolError("usage", f"{name}: {_short(repr(value))} is {what}")


def _short(of) -> str:
    line = " ".join(str(of).split())
    return line if len(line) <= 80 else line[:77] + "..."


def convert(array, dtype, what):
    """Arrays of the caller as those of a layer, without a value that silently becomes another: equal dtypes pass bit for bit; wider floats are
    rounded, and a finite value that would become infinite is refused; integers and booleans pass into u32 where they fit."""
    unmasked(what, array)
    array = plain(what, array)
    if array.dtype == dtype:
        return array
    if array.dtype.kind == "f" and dtype.kind == "f":
        with np.errstate(over="ignore"):
            result = array.astype(dtype)
        _refuse(np.isfinite(array) & ~np.isfinite(result), array, what, dtype)
        return result
    if array.dtype.kind in "bui" and dtype.kind == "u":
        if array.dtype.kind != "b":
            _refuse((array < 0) | (array > np.iinfo(dtype).max), array, what, dtype)
        return array.astype(dtype)
    raise SpoolError("usage", f"{what}: {array.dtype} is not {dtype.name}: convert it with astype")


def _refuse(bad, array, what, dtype):
    if bad.any():
        bad, array = np.atleast_1d(bad), np.atleast_1d(array)
        where = tuple(int(axis[0]) for axis in np.nonzero(bad))
        raise SpoolError("usage", f"{what}: {array[where]} at {list(where)} does not fit {dtype.name}: choose a wider dtype")
