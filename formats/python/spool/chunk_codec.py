"""Stored bytes <-> raw bytes of one record: none, or one zstd frame with an optional byte shuffle.

The frame is measured here, block by block, before the decoder sees it: content size, window and length are facts of the
frame that the specification bounds, and the decoder gets the raw size as a hard limit.
"""
import numpy as np

from . import record_layout as layout
from .arguments import whole
from .error import SpoolError

_LEVEL = 1


def _zstandard():
    try:
        import zstandard
    except ImportError:
        raise SpoolError("missing_package", "compressed records need the Python package zstandard: "
                                            "pip install zstandard") from None
    return zstandard


def shuffle(raw, itemsize):
    """All first bytes of the items, then all second bytes, ..."""
    return np.frombuffer(raw, np.uint8).reshape(-1, itemsize).T.tobytes()


def unshuffle(raw, itemsize):
    return np.frombuffer(raw, np.uint8).reshape(itemsize, -1).T.tobytes()


def level(value):
    """What a caller hands over as one."""
    if not 1 <= whole("compress", value) <= 22:
        raise SpoolError("usage", f"compress: {value} is no level of zstd: 1 to 22, or True")
    return int(value)


def compress(raw, itemsize, level=_LEVEL):
    """-> (codec, filter, stored); stays uncompressed unless more than 5 % is saved."""
    compressor = _zstandard().ZstdCompressor(level=level, write_checksum=True, write_content_size=True)
    stored = compressor.compress(shuffle(raw, itemsize))
    if len(stored) * 100 > len(raw) * 95:
        return layout.CODEC_NONE, layout.FILTER_NONE, raw
    return layout.CODEC_ZSTD, layout.FILTER_SHUFFLE, stored


def decompress(stored, raw_bytes, filter, itemsize):
    """Raw bytes of a zstd record; exactly `raw_bytes` of them or a SpoolError."""
    measure_frame(stored, raw_bytes)
    zstandard = _zstandard()
    try:
        raw = zstandard.ZstdDecompressor(max_window_size=layout.MAX_ZSTD_WINDOW).decompress(
            stored, max_output_size=raw_bytes)
    except (zstandard.ZstdError, MemoryError) as reason:
        raise SpoolError("damaged", f"zstd refuses the payload: {reason}") from None
    if len(raw) != raw_bytes:
        raise SpoolError("damaged", f"zstd payload holds {len(raw)} bytes, not {raw_bytes}")
    return unshuffle(raw, itemsize) if filter == layout.FILTER_SHUFFLE else raw


def measure_frame(stored, raw_bytes):
    """Refuses anything but one zstd frame that fills `stored` and declares `raw_bytes`; see RFC 8878, 3.1.1."""
    def take(count):
        nonlocal position
        if count > len(stored) - position:
            raise SpoolError("damaged", "zstd frame is longer than the record")
        position += count
        return int.from_bytes(stored[position - count:position], "little")

    position = 0
    if take(4) != 0xFD2FB528:
        raise SpoolError("damaged", "payload is not a zstd frame")
    descriptor = take(1)
    if descriptor & 0b1000:
        raise SpoolError("damaged", "zstd frame uses a reserved bit")
    if descriptor & 0b11:
        raise SpoolError("damaged", "zstd frame needs a dictionary")
    if not descriptor & 0b100:
        raise SpoolError("damaged", "zstd frame has no content checksum")
    single_segment = bool(descriptor & 0b100000)
    window = None
    if not single_segment:
        window_byte = take(1)
        base = 1 << (10 + (window_byte >> 3))
        window = base + (base >> 3) * (window_byte & 7)
    size_flag = descriptor >> 6
    if size_flag == 0 and not single_segment:
        raise SpoolError("damaged", "zstd frame does not declare its content size")
    content = take((1, 2, 4, 8)[size_flag]) + (256 if size_flag == 1 else 0)
    if content != raw_bytes:
        raise SpoolError("damaged", f"zstd frame declares {content} bytes, the record {raw_bytes}")
    if window is not None and window > layout.MAX_ZSTD_WINDOW:
        raise SpoolError("damaged", f"zstd window of {window} bytes is larger than 64 MiB")
    last = False
    while not last:
        header = take(3)
        last, kind, size = bool(header & 1), (header >> 1) & 3, header >> 3
        if kind == 3:
            raise SpoolError("damaged", "zstd frame holds a reserved block type")
        take(1 if kind == 1 else size)
    take(4)
    if position != len(stored):
        raise SpoolError("damaged", f"{len(stored) - position} bytes follow the zstd frame")
