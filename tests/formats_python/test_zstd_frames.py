import numpy as np
import pytest
import spool
from spool import chunk_codec

zstandard = pytest.importorskip("zstandard")
RAW = np.arange(5000, dtype="<u2").tobytes() * 2


def frame(**options):
    return zstandard.ZstdCompressor(level=3, **{"write_checksum": True, **options}).compress(RAW)


@pytest.mark.parametrize("itemsize", [2, 4])
def test_shuffle_is_the_formula_of_the_specification(itemsize):
    shuffled = chunk_codec.shuffle(RAW, itemsize)
    count = len(RAW) // itemsize
    for k in range(itemsize):
        for i in (0, 1, 17, count - 1):
            assert shuffled[k * count + i] == RAW[i * itemsize + k]
    assert chunk_codec.unshuffle(shuffled, itemsize) == RAW


def test_good_frame_decodes():
    assert chunk_codec.decompress(frame(), len(RAW), 0, 2) == RAW
    codec, filter, stored = chunk_codec.compress(RAW, 2)
    assert (codec, filter) == (1, 1) and chunk_codec.decompress(stored, len(RAW), filter, 2) == RAW


def test_less_than_five_percent_stays_plain():
    noise = np.random.default_rng(1).bytes(20000)
    assert chunk_codec.compress(noise, 4) == (0, 0, noise)


def bad_frames():
    good = frame()
    yield "other size", good, len(RAW) - 1
    yield "trailing byte", good + b"\0", len(RAW)
    yield "two frames", good + good, len(RAW)
    yield "skippable", b"\x50\x2a\x4d\x18\4\0\0\0abcd" + good, len(RAW)
    yield "no checksum", frame(write_checksum=False), len(RAW)
    yield "no content size", frame(write_content_size=False), len(RAW)
    yield "reserved bit", good[:4] + bytes([good[4] | 8]) + good[5:], len(RAW)
    yield "dictionary id", good[:4] + bytes([good[4] | 1]) + good[5:], len(RAW)
    yield "wrong checksum", good[:-1] + bytes([good[-1] ^ 1]), len(RAW)
    # Magic, descriptor with 4-byte size and checksum, window of 128 MiB, then an empty last block.
    yield "window", b"\x28\xb5\x2f\xfd\x84\x88" + len(RAW).to_bytes(4, "little") + b"\1\0\0" + bytes(4), len(RAW)
    for size in range(len(good)):
        yield f"cut at {size}", good[:size], len(RAW)
    # A block that repeats one byte 2 MiB long, far more than the frame declares.
    yield "bomb", b"\x28\xb5\x2f\xfd\xa4" + (100).to_bytes(4, "little") + (3 | (2 << 20) << 3 & 0xFFFFFF).to_bytes(3, "little") + \
        b"a" + bytes(4), 100


def test_every_other_frame_is_damage():
    for name, stored, size in bad_frames():
        with pytest.raises(spool.SpoolError) as caught:
            chunk_codec.decompress(stored, size, 0, 2)
        assert caught.value.kind == "damaged", name


def test_missing_zstandard_names_the_package(tmp_path, monkeypatch):
    import sys
    path = tmp_path / "compressed.spool"
    spool.write(path, np.zeros((8, 8, 4, 3)), compress=True)
    monkeypatch.setitem(sys.modules, "zstandard", None)
    with spool.open(path) as dump:
        with pytest.raises(spool.SpoolError, match="pip install zstandard") as caught:
            dump.read("radiance")
    assert caught.value.kind == "missing_package"
