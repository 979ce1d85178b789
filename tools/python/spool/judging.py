"""How far an image is from another."""
from __future__ import annotations

import numpy as np

from . import _core
from .error import SpoolError
from .recordings import option_text


def metrics(image: np.ndarray, reference: np.ndarray, *, variance: np.ndarray | None = None,
            standard_errors: bool = False, threads: int = 0, **options) -> dict:
    """Every metric of `spool metrics`, {name: value}, or with `standard_errors` {name: (value, standard error)}.

    Images are [y][x][3]; `variance` is that of the reference's mean. NaN: not defined here. Values of `image` that are
    not finite are an error, as in the program.
    """
    settings = [f"{key}={option_text(value)}" for key, value in options.items()]
    judged = _core.metrics(_image(image, "image"), _image(reference, "reference"),
                           None if variance is None else _image(variance, "variance"), settings, threads)
    return judged if standard_errors else {name: value for name, (value, _) in judged.items()}


def _image(array, name):
    array = np.asarray(array)
    if array.ndim != 3 or array.shape[2] != 3:
        raise SpoolError("usage", f"{name}: has shape {array.shape}, not (height, width, 3)")
    return np.ascontiguousarray(array, np.float64)
