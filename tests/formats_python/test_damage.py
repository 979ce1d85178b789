import zlib

import numpy as np
import pytest
import spool
from spool import record_layout as layout

from container import Container
from sample_files import tiny


def kind_of_open(path):
    try:
        spool.open(path).close()
    except spool.SpoolError as reason:
        assert str(reason).startswith(f"{path}: ") and "\n" not in str(reason)
        return reason.kind
    return None


@pytest.mark.parametrize("compress", [False, True])
def test_every_flipped_bit_is_found(tmp_path, compress):
    path = tmp_path / "flip.spool"
    good = tiny(path, compress)
    assert len(good) < 6000 and (not compress or b"\x28\xb5\x2f\xfd" in good)
    structure = np.zeros(len(good), bool)  # bytes that opening alone must protect
    structure[:64] = structure[-64:] = True
    at = 64
    while at < len(good) - 64:
        structure[at:at + 64] = True
        stored = int.from_bytes(good[at + 24:at + 32], "little")
        if good[at + 4:at + 8] == b"INDX":
            structure[at:] = True
        at += 64 + layout.padded(stored)
    with open(path, "r+b", buffering=0) as file:
        for byte in range(len(good)):
            for bit in range(8):
                file.seek(byte)
                file.write(bytes([good[byte] ^ 1 << bit]))
                if structure[byte]:
                    assert kind_of_open(path) in ("damaged", "incomplete"), (byte, bit)
                else:
                    report = spool.check(path)
                    assert not report.ok and report.errors[0].kind == "damaged", (byte, bit)
            file.seek(byte)
            file.write(good[byte:byte + 1])
    assert spool.check(path).ok


def test_no_truncation_opens(tmp_path):
    path = tmp_path / "cut.spool"
    good = tiny(path)
    for size in range(len(good)):
        path.write_bytes(good[:size])
        assert kind_of_open(path) == "incomplete", size


@pytest.mark.parametrize("extra", [1, 7, 63, 64, 65, 4096])
def test_no_extension_opens(tmp_path, extra):
    path = tmp_path / "long.spool"
    good = tiny(path)
    path.write_bytes(good + bytes(extra))
    assert kind_of_open(path) == "incomplete"
    path.write_bytes(good + good[-extra:])
    assert kind_of_open(path) in ("incomplete", "damaged")
    path.write_bytes(good + good)
    assert kind_of_open(path) == "damaged"


def test_foreign_files_and_text_mode_transfers_are_named(tmp_path):
    path = tmp_path / "other"
    good = tiny(path)
    for data, kind in ((b"", "incomplete"), (b"\x89SP", "incomplete"), (b"PK\3\4", "not_spool"), (b"v/1\1" * 100, "not_spool"),
                       (good.replace(b"\r\n", b"\n"), "damaged"), (b"\x09" + good[1:], "damaged")):
        path.write_bytes(data)
        assert kind_of_open(path) == kind
    assert kind_of_open(tmp_path) == "io" and kind_of_open(tmp_path / "missing") == "io"
    for kind, code in (("not_spool", 1), ("unsupported", 1), ("invalid", 1), ("io", 3), ("incomplete", 4), ("damaged", 4)):
        assert spool.SpoolError(kind, "").code == code


def test_pieces_of_another_dump_are_refused(tmp_path):
    path = tmp_path / "mixed.spool"
    good = tiny(path)
    samples = np.random.default_rng(8).random((3, 9, 3, 3))
    spool.write(path, samples, film=np.ones((3, 2)), scope={"film": "pass"}, reference=samples.mean(axis=2),
                meta={"seed": 7}, tile_size=8, block_spp=2, uuid=bytes(range(1, 17)), force=True)
    other = path.read_bytes()
    assert len(other) == len(good)
    for begin in range(0, len(good), 64):
        mixed = good[:begin] + other[begin:begin + 64] + good[begin + 64:]
        if mixed != good:
            path.write_bytes(mixed)
            assert not spool.check(path).ok, begin
    first, second = Container(good), Container(other)
    for row in range(len(first.records)):
        mixed = first.copy()
        mixed.records[row] = second.records[row]
        path.write_bytes(mixed.build())
        assert kind_of_open(path) == "damaged"


def test_random_damage_is_found(tmp_path):
    path = tmp_path / "random.spool"
    good = tiny(path)
    rng = np.random.default_rng(11)
    for _ in range(1500):
        bad = bytearray(good)
        at, kind = int(rng.integers(0, len(good))), int(rng.integers(0, 4))
        if kind == 0:
            bad[at:at + 32] = rng.bytes(len(bad[at:at + 32]))
        elif kind == 1:
            other = int(rng.integers(0, len(good) // 64)) * 64
            at = at // 64 * 64
            bad[at:at + 64], bad[other:other + 64] = bad[other:other + 64], bad[at:at + 64]
        elif kind == 2:
            bad[at:at + 512] = bytes(len(bad[at:at + 512]))
        else:
            del bad[at:at + int(rng.integers(1, 300))]
        if bad != good:
            path.write_bytes(bad)
            assert not spool.check(path).ok


def test_check_names_each_lost_block(tmp_path):
    path = tmp_path / "lost.spool"
    good = bytearray(tiny(path))
    with spool.open(path) as dump:
        keys = dump.blocks()
        offsets = [int(dump._records.entries[row]["offset"]) for row in dump._table.rows]
    for victim in (1, 3):
        good[offsets[victim] + 64] ^= 4
    path.write_bytes(good)
    report = spool.check(path)
    assert report.lost == [keys[1], keys[3]] and len(report.errors) == 2
    with spool.open(path) as dump:
        with pytest.raises(spool.SpoolError):
            dump.block(*keys[1])
        with pytest.raises(spool.SpoolError):
            dump.read("radiance")


def test_crc32_is_the_one_of_the_specification():
    assert zlib.crc32(b"123456789") == 0xCBF43926
