"""OpenEXR images as `{channel name: array [y][x]}`: what the program `spool` writes, and what it reads.

    from spool import exr
    image = exr.read("statistics.exr")                  # {"R": float32 [y][x], ..., "n": uint32 [y][x]}
    exr.write("counts.exr", {"n": (image["n"] > 4).astype("u4")})

Reads one part of scanlines, RLE, ZIP, ZIPS or no compression; writes scanlines without compression.
The layout is that of OpenEXR's own page "OpenEXR File Layout". Sizes are checked against the
length of the file before anything is allocated.
"""

import contextlib
import os
import secrets
import struct
import zlib

import numpy as np

from .arguments import array, flag, mapping
from .arguments import path as path_of
from .error import SpoolError, open_regular

MAGIC = 20000630
LONG_NAMES = 0x400
NOT_FLAT_SCANLINES = 0x200 | 0x800 | 0x1000  # tiled, deep, multi-part
LINES_PER_CHUNK = {0: 1, 1: 1, 2: 1, 3: 16}  # none, RLE, ZIPS, ZIP
TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
MAX_PIXELS = 1 << 28
DEFLATE_LIMIT = 1032  # no deflate stream expands further


def read(path):
    """{channel name: array [y][x]} in the file's own types: float16, float32 or uint32."""
    name = path_of("path", path)
    try:
        with open_regular(name) as file:
            data = file.read()
    except OSError as error:
        raise SpoolError("io", f"{name}: {error.strerror}") from error
    try:
        return _parse(data)
    except (struct.error, zlib.error, ValueError, IndexError, KeyError, OverflowError) as error:
        raise SpoolError("invalid", f"{name}: not an OpenEXR image that spool writes ({error})") from error


def write(path, channels, *, force=False):
    """Arrays [y][x] of one shape: unsigned integers become uint, float16 half, all else float. A file that exists stays
    unless `force`."""
    final = path_of("path", path)
    if not flag("force", force) and os.path.lexists(final):
        raise SpoolError("usage", f"{final}: exists: choose another name or give force=True")
    if os.path.exists(final) and not os.path.isfile(final):
        raise SpoolError("usage", f"{final}: is no regular file: give the name of a file")
    planes = {}
    for name, plane in mapping("channels", channels).items():
        if not 0 < len(name.encode()) < 256:
            raise SpoolError("usage", f"{final}: {name!r} is no name of a channel")
        plane = array(f"{final}: {name}", plane, "biuf")
        wide = "<u4" if plane.dtype.kind == "u" else "<f2" if plane.dtype.kind == "f" and plane.itemsize == 2 else "<f4"
        with np.errstate(over="ignore"):
            planes[name] = np.ascontiguousarray(plane, wide)
        whole = plane.dtype.kind in "iu"
        if (planes[name] != plane).any() if whole else (np.isinf(planes[name]) & np.isfinite(plane)).any():
            raise SpoolError("usage", f"{final}: {name} has values that are too large for {planes[name].dtype.name}: scale them")
    shapes = {plane.shape for plane in planes.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 2 or 0 in next(iter(shapes)):
        raise SpoolError("usage", f"{final}: channels of shapes {sorted(shapes)}: give arrays [y][x] "
                                  "of one size")
    height, width = shapes.pop()
    kinds = {dtype: kind for kind, dtype in TYPES.items()}
    names = sorted(planes, key=str.encode)
    channel_list = b"".join(name.encode() + struct.pack("<xiIii", kinds[planes[name].dtype], 0, 1, 1)
                            for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", MAGIC, 2 | max(LONG_NAMES * (len(name.encode()) > 31) for name in names))
    for name, kind, value in (("channels", "chlist", channel_list), ("compression", "compression", b"\0"),
                              ("dataWindow", "box2i", window), ("displayWindow", "box2i", window),
                              ("lineOrder", "lineOrder", b"\0"),
                              ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                              ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
                              ("screenWindowWidth", "float", struct.pack("<f", 1))):
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    line = sum(planes[name].itemsize for name in names) * width
    start = len(header) + 8 * height
    partial = f"{final}.spool-{secrets.token_hex(6)}.partial"
    try:
        with open(partial, "xb") as file:
            file.write(header + struct.pack(f"<{height}Q", *(start + y * (line + 8) for y in range(height))))
            for y in range(height):
                file.write(struct.pack("<ii", y, line) + b"".join(planes[name][y].tobytes() for name in names))
        os.replace(partial, final)
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(partial)
        if isinstance(error, OSError):
            raise SpoolError("io", f"{final}: {error.strerror or error}: check the folder and the disk") from error
        raise


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
    if attributes["dataWindow"] != attributes["displayWindow"]:
        raise ValueError("the data window is not the display window")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = _channels(attributes["channels"])
    line_bytes = width * sum(dtype.itemsize for _, dtype in channels)
    if width < 1 or height < 1 or width * height > MAX_PIXELS:
        raise ValueError(f"size {width} x {height}")
    lines = LINES_PER_CHUNK[compression]
    chunks = -(-height // lines)
    if not channels or line_bytes * height > len(data) * DEFLATE_LIMIT or 16 * chunks > len(data):  # each has a place and a head
        raise ValueError("file too short for its size")
    raw = np.empty((height, line_bytes), np.uint8)
    missing = set(range(0, height, lines))
    for offset in struct.unpack_from(f"<{chunks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        y -= y0
        if not 0 <= y < height or y % lines or size < 0 or offset + 8 + size > len(data):
            raise ValueError("a chunk outside the file")
        if y not in missing:  # another one is not there then, and its lines would be what the memory held before
            raise ValueError(f"the chunk of line {y + y0} is there twice")
        missing.remove(y)
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
    unpacked = _run_lengths(packed, size) if compression == 1 else zlib.decompressobj().decompress(packed, size)
    bytes_ = np.frombuffer(unpacked, np.uint8)
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


def _run_lengths(packed, size):
    """A signed count before each run: n + 1 times the next byte, or -n bytes as they stand."""
    parts, at, left = [], 0, size
    while at < len(packed) and left >= 0:
        count = packed[at]
        if count < 128:
            parts.append(packed[at + 1:at + 2] * (count + 1))
            at += 2
        else:
            parts.append(packed[at + 1:at + 1 + 256 - count])
            at += 1 + 256 - count
        left -= len(parts[-1])
    return b"".join(parts)


def _planes(raw, channels, width):
    planes, at = {}, 0
    for name, dtype in channels:
        end = at + width * dtype.itemsize
        planes[name] = np.ascontiguousarray(raw[:, at:end]).view(dtype)
        at = end
    return planes
