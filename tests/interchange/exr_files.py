"""OpenEXR files byte by byte: what other programs write and OpenImageIO does not (named parts, views, statements of colour)."""
import struct

import numpy as np

MAGIC, MULTI_PART = 20000630, 0x1000
KINDS = {"u4": 0, "f2": 1, "f4": 2}


def attribute(name, kind, value):
    return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value


def text(name, value):
    return attribute(name, "string", value.encode())


def texts(name, values):
    return attribute(name, "stringvector", b"".join(struct.pack("<i", len(v)) + v.encode() for v in values))


def number(name, value):
    return attribute(name, "float", struct.pack("<f", value))


def chromaticities(*numbers):
    return attribute("chromaticities", "chromaticities", struct.pack("<8f", *numbers))


AP1 = (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767)
REC2020 = (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290)
XYZ = (1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)


class Part:
    """channels: {name: array [y][x] of half, float or uint32}; more: attributes; origin and display: of the windows."""

    def __init__(self, channels, *more, name=None, view=None, origin=(0, 0), display=None, compression=0, sampling=1):
        self.channels = {c: np.ascontiguousarray(channels[c]) for c in sorted(channels)}
        self.name, self.view, self.more = name, view, more
        self.compression, self.sampling = compression, sampling
        self.height, self.width = next(iter(self.channels.values())).shape
        self.origin = origin
        self.display = display or (0, 0, self.width, self.height)

    def header(self, several):
        def window(name, x, y, width, height):
            return attribute(name, "box2i", struct.pack("<4i", x, y, x + width - 1, y + height - 1))
        listed = b"".join(c.encode() + b"\0" + struct.pack("<iB3xii", KINDS[a.dtype.str[1:]], 0, self.sampling, self.sampling)
                          for c, a in self.channels.items()) + b"\0"
        out = (attribute("channels", "chlist", listed) + attribute("compression", "compression", bytes([self.compression]))
               + window("dataWindow", *self.origin, self.width, self.height) + window("displayWindow", *self.display)
               + attribute("lineOrder", "lineOrder", b"\0") + number("pixelAspectRatio", 1)
               + attribute("screenWindowCenter", "v2f", bytes(8)) + number("screenWindowWidth", 1))
        if self.name is not None:
            out += text("name", self.name)
        if self.view is not None:
            out += text("view", self.view)
        if several:
            out += text("type", "scanlineimage") + attribute("chunkCount", "int", struct.pack("<i", self.height))
        return out + b"".join(self.more) + b"\0"


def write(path, *parts):
    several = len(parts) > 1
    start = struct.pack("<II", MAGIC, 2 | (MULTI_PART if several else 0)) + b"".join(p.header(several) for p in parts) + (b"\0" if several else b"")
    at = len(start) + 8 * sum(p.height for p in parts)
    table, chunks = b"", b""
    for number_, part in enumerate(parts):
        for y in range(part.height):
            row = b"".join(a[y].tobytes() for a in part.channels.values())
            chunk = (struct.pack("<i", number_) if several else b"") + struct.pack("<ii", part.origin[1] + y, len(row)) + row
            table += struct.pack("<Q", at + len(chunks))
            chunks += chunk
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(start + table + chunks)
    return path


def rgb(pixels, layer="", names="RGB", dtype="f4"):
    """{"LAYER.R": ...} of pixels [y][x][3]; dtype: one, or one for each channel."""
    dtypes = dtype if isinstance(dtype, tuple) else (dtype,) * 3
    return {(layer + "." if layer else "") + n: pixels[..., i].astype(t) for i, (n, t) in enumerate(zip(names, dtypes))}


def edited(path, change, out=None):
    """The EXR with change(name, value) for the value of every attribute of text, and its table of offsets moved."""
    data = path.read_bytes()
    at, head, grown = 8, data[:8], 0
    while data[at]:
        name, kind = (part.decode() for part in data[at:].split(b"\0", 2)[:2])
        begin = at + len(name) + len(kind) + 6
        size = struct.unpack_from("<i", data, begin - 4)[0]
        value = data[begin:begin + size]
        new = change(name, value.decode()).encode() if kind == "string" else value
        head, grown, at = head + attribute(name, kind, new), grown + len(new) - size, begin + size
    first = struct.unpack_from("<Q", data, at + 1)[0]  # of the chunks, of a table that ends there
    offsets = np.frombuffer(data[at + 1:first], "<u8") + np.uint64(grown % 2**64)
    (out or path).write_bytes(head + b"\0" + offsets.tobytes() + data[first:])
