"""Images as the numpy module reads them: a file that names a chunk twice has lines that nothing filled."""
import os
import struct
import tracemalloc

import numpy as np
import pytest
import spool
import spool.exr


def test_what_is_there_stays(tmp_path):
    path, one, other = tmp_path / "a.exr", {"Y": np.ones((2, 3), "f4")}, {"Y": np.zeros((2, 3), "f4")}
    (tmp_path / "a.exr.partial").write_bytes(b"of another program")
    spool.exr.write(path, one)
    with pytest.raises(spool.SpoolError, match=r"a\.exr: exists: choose another name or give force=True"):
        spool.exr.write(path, other)
    assert spool.exr.read(path)["Y"].all()
    spool.exr.write(path, other, force=True)
    assert not spool.exr.read(path)["Y"].any()
    os.mkfifo(tmp_path / "fifo")
    for name in ("fifo", "."):
        with pytest.raises(spool.SpoolError, match="is no regular file: give the name of a file"):
            spool.exr.write(tmp_path / name, one, force=True)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.exr", "a.exr.partial", "fifo"]
    assert (tmp_path / "fifo").is_fifo() and (tmp_path / "a.exr.partial").read_bytes() == b"of another program"


@pytest.mark.parametrize("first, second", [(0, 0), (0, 2), (3, 3)])
def test_each_chunk_is_there_once(tmp_path, first, second):
    path = tmp_path / "a.exr"
    spool.exr.write(path, {"Y": np.arange(12, dtype="f4").reshape(4, 3)})
    data = bytearray(path.read_bytes())
    start = len(data) - 4 * (8 + 12) - 4 * 8
    offsets = list(struct.unpack_from("<4Q", data, start))
    struct.pack_into("<4Q", data, start, *reversed(offsets))  # in any order
    path.write_bytes(data)
    assert spool.exr.read(path)["Y"].tolist() == np.arange(12).reshape(4, 3).tolist()
    offsets[first] = offsets[second] if first != second else offsets[first - 1]
    struct.pack_into("<4Q", data, start, *offsets)
    path.write_bytes(data)
    with pytest.raises(spool.SpoolError, match=r"a\.exr: .*twice") as caught:
        spool.exr.read(path)
    assert caught.value.kind == "invalid" and "\n" not in str(caught.value)


def test_a_file_too_short_for_its_chunks_takes_no_memory(tmp_path):
    path, height = tmp_path / "a.exr", 1 << 27
    spool.exr.write(path, {"Y": np.zeros((1, 1), "f2")})
    window = b"box2i\0" + struct.pack("<i", 16)
    data = path.read_bytes().replace(window + bytes(16), window + struct.pack("<4i", 0, 0, 0, height - 1))
    path.write_bytes(data + bytes(2 * height // 1032))
    tracemalloc.start()
    try:
        with pytest.raises(spool.SpoolError, match="file too short"):
            spool.exr.read(path)
        assert tracemalloc.get_traced_memory()[1] < 4 * path.stat().st_size
    finally:
        tracemalloc.stop()


def test_halves_of_either_byte_order_stay_halves(tmp_path):
    for order in "<>":
        spool.exr.write(tmp_path / "a.exr", {"Y": np.full((2, 3), 0.5, order + "f2")}, force=True)
        assert spool.exr.read(tmp_path / "a.exr")["Y"].dtype == np.float16


@pytest.mark.parametrize("name, flags", [("x" * 31, 0), ("x" * 32, 0x400), ("ü" * 16, 0x400)])
def test_long_names_are_announced(tmp_path, name, flags):
    spool.exr.write(tmp_path / "a.exr", {name: np.ones((2, 3), "f4"), "Y": np.zeros((2, 3), "f4")})
    assert struct.unpack_from("<I", (tmp_path / "a.exr").read_bytes(), 4) == (2 | flags,)
    assert spool.exr.read(tmp_path / "a.exr")[name].all()


def test_a_picture_of_another_place_is_not_taken_for_one_at_the_origin(tmp_path):
    path = tmp_path / "a.exr"
    spool.exr.write(path, {"Y": np.ones((4, 3), "f4")})
    window, moved = struct.pack("<4i", 0, 0, 2, 3), struct.pack("<4i", -1, 0, 1, 3)
    data = path.read_bytes()
    path.write_bytes(data.replace(b"displayWindow\0box2i\0\x10\0\0\0" + window, b"displayWindow\0box2i\0\x10\0\0\0" + moved))
    with pytest.raises(spool.SpoolError, match="a.exr: not an OpenEXR image that spool writes .the data window is not the display window"):
        spool.exr.read(path)


@pytest.mark.parametrize("call", [
    lambda to: spool.exr.read(None), lambda to: spool.exr.read("a\0.exr"), lambda to: spool.exr.write(None, {"Y": np.ones((2, 3))}),
    lambda to: spool.exr.write(to, [np.ones((2, 3))]), lambda to: spool.exr.write(to, {"\ud800": np.ones((2, 3))}),
    lambda to: spool.exr.write(to, {7: np.ones((2, 3))}), lambda to: spool.exr.write(to, {"": np.ones((2, 3))})])
def test_arguments_of_the_wrong_kind_are_a_spool_error(call, tmp_path):
    with pytest.raises(spool.SpoolError):
        call(tmp_path / "a.exr")
    assert not list(tmp_path.iterdir())
