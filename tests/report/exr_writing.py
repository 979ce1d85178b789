"""Writes small EXR scanline files for tests: float, half or uint channels; ZIP, ZIPS or none."""

import struct
import zlib

import numpy as np

TYPES = {np.dtype("u4"): 0, np.dtype("f2"): 1, np.dtype("f4"): 2}
LINES = {0: 1, 2: 1, 3: 16}


def _attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def _deflate(raw):
    halves = raw[0::2] + raw[1::2]
    values = np.frombuffer(halves, np.uint8)
    steps = values.copy()
    steps[1:] = values[1:] - values[:-1] + np.uint8(128)
    packed = zlib.compress(steps.tobytes())
    return packed if len(packed) < len(raw) else raw


def exr_bytes(channels, compression=3, origin=(0, 0)):
    """`channels`: {name: array [y][x]}, all of one size."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    x0, y0 = origin
    window = struct.pack("<4i", x0, y0, x0 + width - 1, y0 + height - 1)
    described = b"".join(name.encode() + b"\0" + struct.pack("<iIii", TYPES[channels[name].dtype], 0, 1, 1)
                         for name in names) + b"\0"
    head = (struct.pack("<II", 20000630, 2)
            + _attribute("channels", "chlist", described)
            + _attribute("compression", "compression", bytes([compression]))
            + _attribute("dataWindow", "box2i", window) + _attribute("displayWindow", "box2i", window)
            + _attribute("lineOrder", "lineOrder", b"\0")
            + _attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0))
            + _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0))
            + _attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)) + b"\0")
    chunks = []
    for y in range(0, height, LINES[compression]):
        raw = b"".join(channels[name][line].tobytes() for line in range(y, min(height, y + LINES[compression]))
                       for name in names)
        data = raw if compression == 0 else _deflate(raw)
        chunks.append(struct.pack("<ii", y0 + y, len(data)) + data)
    offsets, at = [], len(head) + 8 * len(chunks)
    for chunk in chunks:
        offsets.append(at)
        at += len(chunk)
    return head + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(chunks)


def write_exr(path, channels, **options):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(exr_bytes(channels, **options))
