"""Offsets, sizes, enumerations and limits of formats/spool.md as numpy types; nothing else.

Each structure is 64 bytes, little-endian, without implied padding; tests compare the field offsets with the tables of
the specification.
"""
import zlib

import numpy as np

ALIGN = 64

FILE_HEADER = np.dtype([
    ("magic", "V8"), ("major", "<u2"), ("minor", "<u2"), ("required_features", "<u4"),
    ("dump_uuid", "V16"), ("reserved", "V28"), ("crc32", "<u4")])

RECORD_HEADER = np.dtype([
    ("sync", "V4"), ("type", "V4"), ("sequence", "<u8"), ("dump_id", "<u8"),
    ("stored_bytes", "<u8"), ("raw_bytes", "<u8"), ("payload_crc32", "<u4"),
    ("codec", "u1"), ("filter", "u1"), ("group", "<u2"), ("tile", "<u4"),
    ("sample_begin", "<u4"), ("sample_count", "<u4"), ("crc32", "<u4")])

IMAG = np.dtype([
    ("width", "<u4"), ("height", "<u4"), ("tile_size", "<u4"), ("spp", "<u4"), ("block_spp", "<u4"),
    ("group_count", "<u4"), ("channel_count", "<u4"), ("pixel_filter", "<u4"),
    ("colour_space", "<u4"), ("sample_order", "<u4"), ("reserved", "V24")])

CHAN = np.dtype([
    ("name", "V32"), ("group", "<u2"), ("dtype", "<u2"), ("semantic", "<u2"), ("scope", "<u2"),
    ("reserved", "V24")])

# The file offset, then bytes 4 to 59 of the record header.
INDEX_ENTRY = np.dtype([("offset", "<u8")] + [
    (name, RECORD_HEADER.fields[name][0]) for name in RECORD_HEADER.names[1:-1]])

FOOTER = np.dtype([
    ("index_offset", "<u8"), ("file_bytes", "<u8"), ("record_count", "<u8"), ("dump_id", "<u8"),
    ("data_record_count", "<u8"), ("flags", "<u4"), ("reserved", "V8"), ("end_magic", "V8"),
    ("crc32", "<u4")])

MAGIC = b"\x89SPL\r\n\x1a\n"
SYNC = b"\x9eREC"
END_MAGIC = b"SPLEND\r\n"
MAJOR, MINOR = 1, 0
KNOWN_FEATURES = 0
FLAG_COMPLETE = 1

CODEC_NONE, CODEC_ZSTD = 0, 1
FILTER_NONE, FILTER_SHUFFLE = 0, 1
DTYPES = {1: np.dtype("<f2"), 2: np.dtype("<f4"), 3: np.dtype("<u4")}
SAMPLE_ORDERS = ("renderer", "exchangeable")
SCOPES = ("sample", "pixel", "pass")
PIXEL_FILTERS = ("box",)
COLOUR_SPACES = ("linear_rec709",)

MAX_SIDE = 65536
MAX_PIXELS = 1 << 28
MAX_SPP = 65536
MAX_BLOCK_SPP = 1024
MIN_TILE, MAX_TILE = 8, 256
MIN_CHANNELS, MAX_CHANNELS = 3, 64
MAX_GROUPS = 16
MAX_RAW_BYTES = 64 << 20
MAX_RECORDS = 1 << 20
MAX_BLOCKS = (1 << 20) - 1024
MIN_META_BYTES, MAX_META_BYTES = 2, 1 << 20
MAX_META_RECORDS = 64
MAX_META_DEPTH = 64
MAX_SEMANTIC = 9
MAX_ZSTD_WINDOW = 64 << 20


def padded(count):
    """`count` bytes rounded up to whole 64-byte units."""
    return -(-count // ALIGN) * ALIGN


def seal(structure):
    """Stores the CRC of bytes 0 to 59 in bytes 60 to 63; returns the 64 bytes."""
    structure["crc32"] = zlib.crc32(structure.tobytes()[:60])
    return structure.tobytes()


def parse(dtype, data):
    """64 bytes -> (structure, its own CRC agrees)."""
    structure = np.frombuffer(data, dtype, 1)[0]
    return structure, int(structure["crc32"]) == zlib.crc32(data[:60])


for _dtype in (FILE_HEADER, RECORD_HEADER, IMAG, CHAN, INDEX_ENTRY, FOOTER):
    assert _dtype.itemsize == ALIGN
