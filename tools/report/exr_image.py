"""Reads the OpenEXR files that Spool writes: one part, scanlines, ZIP, ZIPS or no compression.

Channels come back as arrays [y][x] in the type of the file (half, float, uint); the layout
is that of OpenEXR's own page "OpenEXR File Layout".
Sizes are checked against the length of the file before anything is allocated.
"""

import struct
import zlib

import numpy as np

from failure import Failure

MAGIC = 20000630
NOT_FLAT_SCANLINES = 0x200 | 0x800 | 0x1000  # tiled, deep, multi-part
LINES_PER_CHUNK = {0: 1, 2: 1, 3: 16}  # none, ZIPS, ZIP
TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
MAX_PIXELS = 1 << 28
DEFLATE_LIMIT = 1032  # no deflate stream expands further


def read_exr(path):
    """{channel name: array [y][x]}"""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Failure(f"{path}: {error.strerror}: run spool evaluate again", 3) from error
    try:
        return _parse(data)
    except (struct.error, zlib.error, ValueError, IndexError, KeyError, OverflowError) as error:
        raise Failure(f"{path}: not an OpenEXR image that spool writes ({error}): "
                      "run spool evaluate again") from error


def _parse(data):
    magic, version = struct.unpack_from("<II", data)
    if magic != MAGIC:
        raise ValueError("wrong first bytes")
    if version & NOT_FLAT_SCANLINES:
        raise ValueError("tiled, deep or of several parts")
    attributes, at = _header(data, 8)
    compression = attributes["compression"][0]
    if compression not in LINES_PER_CHUNK:
        raise ValueError(f"compression {compression}")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = _channels(attributes["channels"])
    line_bytes = width * sum(dtype.itemsize for _, dtype in channels)
    if width < 1 or height < 1 or width * height > MAX_PIXELS:
        raise ValueError(f"size {width} x {height}")
    if not channels or line_bytes * height > len(data) * DEFLATE_LIMIT:
        raise ValueError("file too short for its size")
    lines = LINES_PER_CHUNK[compression]
    raw = np.empty((height, line_bytes), np.uint8)
    for offset in struct.unpack_from(f"<{-(-height // lines)}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        y -= y0
        if not 0 <= y < height or y % lines or size < 0 or offset + 8 + size > len(data):
            raise ValueError("a chunk outside the file")
        count = min(lines, height - y)
        raw[y:y + count] = _chunk(data[offset + 8:offset + 8 + size], count * line_bytes,
                                  compression).reshape(count, line_bytes)
    return _planes(raw, channels, width)


def _header(data, at):
    attributes = {}
    while data[at] != 0:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        start = type_end + 5
        if size < 0 or start + size > len(data):
            raise ValueError("an attribute outside the file")
        attributes[data[at:name_end].decode()] = data[start:start + size]
        at = start + size
    return attributes, at + 1


def _channels(data):
    channels, at = [], 0
    while data[at] != 0:
        end = data.index(b"\0", at)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", data, end + 1)
        if (x_sampling, y_sampling) != (1, 1):
            raise ValueError("subsampled channels")
        channels.append((data[at:end].decode(), TYPES[kind]))
        at = end + 17
    return channels


def _chunk(packed, size, compression):
    if compression == 0 or len(packed) == size:
        if len(packed) != size:
            raise ValueError("a chunk of the wrong length")
        return np.frombuffer(packed, np.uint8)
    inflate = zlib.decompressobj()
    bytes_ = np.frombuffer(inflate.decompress(packed, size), np.uint8)
    if len(bytes_) != size:
        raise ValueError("a chunk of the wrong length")
    # Differences around 128, then the two halves of the chunk interleaved.
    steps = bytes_.copy()
    steps[1:] -= np.uint8(128)
    values = np.cumsum(steps, dtype=np.uint8)
    half = (size + 1) // 2
    result = np.empty(size, np.uint8)
    result[0::2] = values[:half]
    result[1::2] = values[half:]
    return result


def _planes(raw, channels, width):
    planes, at = {}, 0
    for name, dtype in channels:
        end = at + width * dtype.itemsize
        planes[name] = np.ascontiguousarray(raw[:, at:end]).view(dtype)
        at = end
    return planes


def rgb(planes):
    """[y][x][c] float32 of R, G, B; a single channel is grey."""
    names = ("R", "G", "B") if "R" in planes else (next(iter(planes)),) * 3
    return np.stack([planes[name].astype(np.float32) for name in names], axis=-1)


def single(planes):
    """[y][x] float32 of the only channel."""
    return next(iter(planes.values())).astype(np.float32)
