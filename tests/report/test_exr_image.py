import numpy as np
import pytest
from exr_writing import exr_bytes, write_exr

from tools.report.exr_image import read_exr, rgb, single
from tools.report.failure import Failure


@pytest.mark.parametrize("compression", [0, 2, 3])
@pytest.mark.parametrize("size", [(1, 1), (7, 5), (33, 40)])
def test_every_type_and_compression_comes_back_bit_for_bit(tmp_path, compression, size):
    random = np.random.default_rng(3)
    height, width = size
    channels = {"A": random.standard_normal(size).astype("<f4"), "n": random.integers(0, 2 ** 32, size, "u4"),
                "h": (np.arange(height * width).reshape(size) / 8).astype("<f2")}
    write_exr(tmp_path / "a.exr", channels, compression=compression, origin=(-3, 11))
    read = read_exr(tmp_path / "a.exr")
    assert sorted(read) == ["A", "h", "n"]
    for name, plane in channels.items():
        assert read[name].dtype == plane.dtype
        assert read[name].tobytes() == plane.tobytes()


def test_one_channel_is_grey_and_colours_are_in_order():
    plane = np.full((2, 3), 5.0, "f4")
    assert rgb({"Y": plane}).shape == (2, 3, 3)
    assert rgb({"B": plane * 3, "G": plane * 2, "R": plane})[0, 0].tolist() == [5.0, 10.0, 15.0]
    assert single({"n": plane})[1, 2] == 5.0


def test_damage_anywhere_is_a_failure_or_an_image_but_nothing_else(tmp_path):
    whole = exr_bytes({"Y": np.arange(12, dtype="f4").reshape(3, 4)}, compression=3)
    path = tmp_path / "damaged.exr"
    failures = 0
    for at in range(len(whole)):
        for damaged in (whole[:at], whole[:at] + bytes([whole[at] ^ 0xff]) + whole[at + 1:]):
            path.write_bytes(damaged)
            try:
                read_exr(path)
            except Failure as failure:
                failures += 1
                assert "\n" not in str(failure)
    assert failures > len(whole)  # every cut, and many flips


def test_a_huge_size_in_a_short_file_allocates_nothing(tmp_path):
    whole = bytearray(exr_bytes({"Y": np.zeros((2, 2), "f4")}))
    for name in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
        at = whole.index(name) + len(name) + 4
        whole[at + 8:at + 16] = (16000).to_bytes(4, "little") * 2
    (tmp_path / "huge.exr").write_bytes(whole)
    with pytest.raises(Failure, match="too short"):
        read_exr(tmp_path / "huge.exr")
