"""The OpenEXR files that Spool writes, read by the numpy package `spool` (formats/python)."""

import sys
from pathlib import Path

from failure import Failure

HERE = Path(__file__).resolve().parent
for folder in (HERE.parents[1] / "formats" / "python", HERE.parent / "python"):  # the tree; installed
    if (folder / "spool" / "exr.py").exists():
        sys.path.append(str(folder))

import numpy as np  # noqa: E402
from spool import SpoolError, exr  # noqa: E402


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
