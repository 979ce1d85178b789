"""Arrays of the caller -> arrays of a layer, without a value that silently becomes another.

Equal dtypes pass bit for bit. Wider floats are rounded to the layer's dtype, and a finite value that would become
infinite is refused. Integers and booleans pass into u32 where they fit.
"""
import numpy as np

from .error import SpoolError


def convert(array, dtype, what):
    array = np.asarray(array)
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
