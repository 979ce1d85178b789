"""Images: arrays that a notebook shows; and how far one is from another."""
from __future__ import annotations

import base64
import json
from collections.abc import Iterable

import numpy as np

from . import _core
from .arguments import array, flag, image_size, option_text, texts, whole
from .error import SpoolError

_MOST_SIDE = 512  # pixels of a picture in a cell
_LEAST_WIDE = 256  # CSS pixels


class Image(np.ndarray):
    """An image [y][x][3] of linear values: an array in everything, which a notebook shows with its numbers."""

    def __array_wrap__(self, array, context=None, return_scalar=False):
        array = np.asarray(array)
        if array.ndim == 0:
            return array[()]
        return array.view(Image) if array.ndim == 3 and array.shape[2] == 3 else array

    def _repr_html_(self):
        if self.ndim != 3 or self.shape[2] != 3 or self.dtype.kind != "f" or 0 in self.shape:
            return None  # shown as an array
        image = image_array(self, "image")
        facts = json.loads(_core.image_statistics(image))
        height, width = self.shape[:2]
        shrunk = -(-max(height, width) // _MOST_SIDE)
        said = [f"{width} x {height} pixels" + (f", shrunk by {shrunk} here" if shrunk > 1 else "")]
        if facts["luminance"] is not None:
            said.append(f"mean luminance {facts['luminance']:.4g}, values {facts['smallest']:.4g} to {facts['largest']:.4g}")
        if facts["not_finite"]:
            said.append(f"{facts['not_finite']} pixels not finite (magenta)")
        return figure(_core.tone_mapped_png(image, None, _MOST_SIDE), "; ".join(said))


def figure(png: bytes, caption: str) -> str:
    """HTML of a picture with a line of HTML below; pixels of a small one are drawn large."""
    width = int.from_bytes(png[16:20], "big")  # of its header
    wide = width * max(1, -(-_LEAST_WIDE // width))
    drawn = "; image-rendering: pixelated" if wide > width else ""
    return (f'<figure style="margin: 0"><img alt="" style="width: {wide}px; max-width: 100%{drawn}" '
            f'src="data:image/png;base64,{base64.b64encode(png).decode()}"><figcaption>{caption}</figcaption></figure>')


def image_array(image, name: str) -> np.ndarray:
    """[y][x][3] float64 of an array [y][x][3], or of grey [y][x]."""
    values = array(name, image, "f")
    if values.ndim != 2 and (values.ndim != 3 or values.shape[2] != 3):
        raise SpoolError("usage", f"{name}: has shape {values.shape}, not (height, width, 3) or (height, width)")
    image_size(name, values.shape)
    if values.ndim == 2:
        values = np.repeat(values[..., None], 3, axis=2)
    return np.ascontiguousarray(values, np.float64)


def metrics(image: np.ndarray, reference: np.ndarray, *, metrics: Iterable[str] | None = None,
            variance: np.ndarray | None = None, standard_errors: bool = False, threads: int = 0, **options) -> dict:
    """The metrics of `spool metrics` as {name: value}, or with `standard_errors` {name: (value, standard error)}.

    `metrics`: the names of those wanted, which alone are computed (None: all). Images are [y][x][3]; `variance` is that of
    the reference's mean. NaN: not defined here. Values of `image` that are not finite are an error, as in the program.
    """
    settings = [f"{key}={option_text(value)}" for key, value in options.items()]
    wanted = [] if metrics is None else texts("metrics", metrics)
    if metrics is not None and not wanted:
        raise SpoolError("usage", "metrics: is empty: name some, or None for all")
    with_errors = flag("standard_errors", standard_errors)
    judged = _core.metrics(_image(image, "image"), _image(reference, "reference"),
                           None if variance is None else _variance(variance), settings, wanted,
                           whole("threads", threads))
    return judged if with_errors else {name: value for name, (value, _) in judged.items()}


def _variance(values):
    variance = _image(values, "variance")
    odd = np.argwhere(~(variance >= 0))  # NaN, too
    if len(odd):
        y, x, c = odd[0]
        raise SpoolError("data", f"variance: {variance[y, x, c]} is no variance (pixel {x}, {y}): it is at least 0")
    return variance


def _image(values, name):
    values = array(name, values, "f")
    if values.ndim != 3 or values.shape[2] != 3:
        raise SpoolError("usage", f"{name}: has shape {values.shape}, not (height, width, 3)")
    image_size(name, values.shape)
    return np.ascontiguousarray(values, np.float64)
