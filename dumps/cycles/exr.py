"""Reads uncompressed multilayer EXR files as Blender writes them: scan lines, float32, one part.

Only what the recorder itself asked Blender for; anything else is refused. [OpenEXR file layout]
"""
import struct
from array import array

from dumps.recording.failure import io_failure

FLOAT = 2


def read_exr(path):
    """{pass name: (flat float32 array, components)}, rows bottom-up and components in the order the
    engine keeps them (RGBA, XYZ, Z), so that both ways to the pixels give the same arrays."""
    with open(path, "rb") as stream:
        data = stream.read()
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0x1A00:        # tiled, deep or multi-part
        raise io_failure("%s: not a single-part scan-line EXR (version %#x)" % (path, version))
    attributes, at = _read_header(data, 8)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = _read_channels(attributes["channels"], path)
    if attributes["compression"] != b"\0":
        raise io_failure("%s: compressed EXR" % path)
    planes = {name: [None] * height for name in channels}
    for offset in struct.unpack_from("<%dQ" % height, data, at):
        y, size = struct.unpack_from("<iI", data, offset)
        if size != 4 * width * len(channels):
            raise io_failure("%s: line %d has %d bytes" % (path, y, size))
        for i, name in enumerate(channels):
            start = offset + 8 + 4 * width * i
            planes[name][y - y0] = data[start:start + 4 * width]
    return _gather(planes)


def _read_header(data, at):
    attributes = {}
    while data[at]:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        size, = struct.unpack_from("<i", data, type_end + 1)
        start = type_end + 5
        attributes[data[at:name_end].decode()] = data[start:start + size]
        at = start + size
    return attributes, at + 1


def _read_channels(data, path):
    names, at = [], 0
    while data[at]:
        end = data.index(b"\0", at)
        if struct.unpack_from("<i", data, end + 1)[0] != FLOAT:
            raise io_failure("%s: channel %s is not float32" % (path, data[at:end].decode()))
        names.append(data[at:end].decode())
        at = end + 17
    return names


def _gather(planes):
    """`Layer.Pass.C` planes -> interleaved passes."""
    groups = {}
    for name, rows in planes.items():
        _, render_pass, component = name.rsplit(".", 2) if name.count(".") > 1 else ("", *name.split("."))
        groups.setdefault(render_pass, {})[component] = array("f", b"".join(reversed(rows)))
    found = {}
    for render_pass, parts in groups.items():
        order = [c for c in "RGBAXYZ" if c in parts] or sorted(parts)
        flat = array("f", bytes(4 * len(order) * len(parts[order[0]])))
        for i, component in enumerate(order):
            flat[i::len(order)] = parts[component]
        found[render_pass] = (flat, len(order))
    return found
