"""How far an image is from another."""
from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from . import _core
from .arguments import array, flag, image_size, option_text, texts, whole
from .error import SpoolError


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
                           None if variance is None else _image(variance, "variance"), settings, wanted,
                           whole("threads", threads))
    return judged if with_errors else {name: value for name, (value, _) in judged.items()}


def _image(values, name):
    values = array(name, values)
    if values.ndim != 3 or values.shape[2] != 3:
        raise SpoolError("usage", f"{name}: has shape {values.shape}, not (height, width, 3)")
    image_size(name, values.shape)
    return np.ascontiguousarray(values, np.float64)
