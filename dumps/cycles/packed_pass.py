"""The bytes of a pass, packed: pieces of PIECE_ROWS rows of a plane, shuffled and compressed one by one (formats/pass_file.h).

Blender's Python may lack zstandard; passes are plain then, and three times as large.
"""
import struct

try:
    import zstandard
except ImportError:
    zstandard = None

PIECE_ROWS = 64
CODEC = "zstd-shuffle"
LEVEL, LEAST_SAVED = 1, 0.05       # as blocks of a recording


def _pieces(plane_bytes, row_bytes):
    return [(at, min(at + PIECE_ROWS * row_bytes, plane_bytes)) for at in range(0, plane_bytes, PIECE_ROWS * row_bytes)]


def pack(data, width, height):
    """float32 [plane][y][x] -> (bytes of the file, what its line says of them)."""
    if not zstandard:
        return data, {}
    compressor = zstandard.ZstdCompressor(level=LEVEL, write_checksum=True, write_content_size=True)
    parts, plane = [], 4 * width * height
    for start in range(0, len(data), plane):
        for begin, end in _pieces(plane, 4 * width):
            raw = data[start + begin:start + end]
            stored = compressor.compress(b"".join(raw[byte::4] for byte in range(4)))
            parts.append(stored if len(stored) < (1 - LEAST_SAVED) * len(raw) else raw)
    return struct.pack("<%dI" % len(parts), *map(len, parts)) + b"".join(parts), {"codec": CODEC}


def unpack(data, line, width, height, planes):
    """line: of the log. The inverse of pack."""
    if "codec" not in line:
        return data
    pieces = planes * _pieces(4 * width * height, 4 * width)
    sizes, found = struct.unpack_from("<%dI" % len(pieces), data), []
    at = 4 * len(sizes)
    for size, (begin, end) in zip(sizes, pieces):
        raw = data[at:at + size]
        if size < end - begin:
            shuffled = zstandard.ZstdDecompressor().decompress(raw, max_output_size=end - begin)
            items, raw = (end - begin) // 4, bytearray(end - begin)
            for byte in range(4):
                raw[byte::4] = shuffled[byte * items:(byte + 1) * items]
        found.append(bytes(raw))
        at += size
    return b"".join(found)
