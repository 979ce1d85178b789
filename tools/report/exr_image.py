"""The OpenEXR files that Spool writes, read by the numpy package `spool` (formats/python)."""

import numpy as np

from spool import SpoolError, exr
from tools.report.failure import Failure


def read_exr(path):
    """{channel name: array [y][x]}"""
    try:
        return exr.read(path)
    except SpoolError as error:
        raise Failure(f"{error.message}: run spool evaluate again", error.code) from error


def rgb(planes):
    """[y][x][c] float32 of R, G, B; a single channel is grey."""
    names = ("R", "G", "B") if "R" in planes else (next(iter(planes)),) * 3
    return np.stack([planes[name].astype(np.float32) for name in names], axis=-1)


def single(planes):
    """[y][x] float32 of the only channel."""
    return next(iter(planes.values())).astype(np.float32)
