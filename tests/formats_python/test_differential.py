"""The C++ and the numpy implementation against each other, through tests/formats/spool_roundtrip_tool.cpp.

SPOOL_ROUNDTRIP_TOOL names the program; ctest sets it.
"""
import os
import signal
import zlib

import numpy as np
import pytest
import spool
from spool import record_layout as layout

from container import Container
from differential_fuzz import TOOL, damaged_golden_files, differences, tool
from sample_files import random_file, tiny

WHOLE = os.environ.get("SPOOL_TRUST") == "whole"
pytestmark = pytest.mark.skipif(TOOL is None, reason="SPOOL_ROUNDTRIP_TOOL is not set; run it through ctest")


def rewrite_in_numpy(source, target):
    """As the tool does: meta first, then group, tile, block."""
    with spool.open(source) as dump:
        with spool.Writer(target, dump.width, dump.height, dump.spp, channels=dump.channels, tile_size=dump.tile_size,
                          block_spp=dump.block_spp, sample_order=dump.sample_order, uuid=dump.uuid) as writer:
            for text in dump.meta_records:
                writer.write_meta(text)
            for key in sorted(dump.blocks()):
                writer.write_block(*key, dump.block(*key))


@pytest.mark.parametrize("compress", [False, True])
def test_cpp_and_numpy_write_the_same_bytes(tmp_path, compress):
    count, commands = 500 if WHOLE else 150, []
    blocks = []
    for seed in range(count):
        blocks.append(random_file(tmp_path / f"{seed}.a", np.random.default_rng(1000 * compress + seed), compress,
                                  complete=seed % 4 != 0)[0])
        commands += [tmp_path / f"{seed}.a", tmp_path / f"{seed}.b"]
    assert tool("rewrite", *commands) == ["0"] * count
    commands = []
    for seed in range(count):
        with spool.open(tmp_path / f"{seed}.b") as dump:
            assert dump.blocks() == sorted(blocks[seed])
            for key, block in blocks[seed].items():
                assert dump.block(*key).tobytes() == block.tobytes()
        rewrite_in_numpy(tmp_path / f"{seed}.b", tmp_path / f"{seed}.c")
        assert (tmp_path / f"{seed}.b").read_bytes() == (tmp_path / f"{seed}.c").read_bytes()
        commands += [tmp_path / f"{seed}.c", tmp_path / f"{seed}.d"]
    assert tool("rewrite", *commands) == ["0"] * count
    for seed in range(count):
        assert (tmp_path / f"{seed}.c").read_bytes() == (tmp_path / f"{seed}.d").read_bytes()


def agree(paths):
    """Both refuse or both accept, with the same exit code, at opening and at checking, and read the same samples."""
    accepted, found = differences(paths)
    assert not found, "\n".join(text for _, text in found)
    return accepted


def test_same_verdict_on_every_lie(tmp_path):
    """Each field of each structure to 0, 1, all ones, half of all ones, and one up and down; CRCs are right."""
    good = Container(tiny(tmp_path / "good.spool", compress=True))
    paths = []

    def save(lie, name):
        paths.append(tmp_path / f"{len(paths)}_{name}")
        paths[-1].write_bytes(lie.build())

    def values(structure, field):
        size = structure.dtype.fields[field][0].itemsize
        old = int.from_bytes(structure[field].tobytes(), "little")
        for value in {0, 1, 2, 3, 7, 256, (1 << 8 * size) - 1, (1 << 8 * size - 1) - 1, old + 1, abs(old - 1)} - {old}:
            if value < 1 << 8 * size:
                yield np.frombuffer(value.to_bytes(size, "little"), structure.dtype.fields[field][0])[0]

    def payload_fields(row, dtype):
        table = np.frombuffer(good.records[row][1], dtype)
        for entry in range(len(table)):
            for field in dtype.names:
                for value in values(table[entry], field):
                    lie = good.copy()
                    changed = table.copy()
                    changed[entry][field] = value
                    lie.records[row][1] = changed.tobytes()
                    save(lie, f"{dtype.names[0]}{entry}_{field}")

    for field in layout.FILE_HEADER.names[:-1]:
        for value in values(good.head, field):
            lie = good.copy()
            lie.head[field] = value
            save(lie, f"head_{field}")
    for row in range(len(good.records)):
        for field in layout.RECORD_HEADER.names[:-2]:
            if field != "payload_crc32":
                for value in values(good.records[row][0], field):
                    lie = good.copy()
                    lie.records[row][0][field] = value
                    save(lie, f"record{row}_{field}")
    payload_fields(0, layout.IMAG)
    payload_fields(1, layout.CHAN)
    for which, structure in ((1, good.index_header), (2, good.foot)):
        built = good.build()
        at = len(built) - 64 if which == 2 else int.from_bytes(built[-64:-56], "little")
        structure = np.frombuffer(built, structure.dtype, 1, at)[0]
        for field in structure.dtype.names[:-1]:
            for value in values(structure, field):
                lie = good.copy()

                def change(entries, header, foot, which=which, field=field, value=value):
                    (header if which == 1 else foot)[field] = value
                lie.lie_in_index = change
                save(lie, f"{'index' if which == 1 else 'foot'}_{field}")
    for row in range(2):
        for change in (-64 * 6, -64, -1, 1, 36, 64, 64 * 57, 64 * 60):
            lie = good.copy()
            header, payload = lie.records[row]
            payload = (payload + bytes(max(change, 0)))[:len(payload) + change]
            if payload:
                header["stored_bytes"] = header["raw_bytes"] = len(payload)
                lie.records[row][1] = payload
                save(lie, f"record{row}_size")
    assert len(paths) > 1000
    agree(paths)


def test_same_verdict_on_two_faults_in_different_places(tmp_path):
    """The first record in the file decides, whichever rule it breaks; also against an index that does not add up."""
    good = Container(tiny(tmp_path / "good.spool", compress=True))
    faults = [("type", np.void(b"DATB")), ("type", np.void(b"DAT1")), ("sequence", 99), ("dump_id", 1), ("codec", 2), ("filter", 2),
              ("raw_bytes", 2**26 + 1), ("stored_bytes", 0), ("stored_bytes", 2**63), ("stored_bytes", 2**26 + 64)]
    paths = []
    for first, one in enumerate(faults):
        for second, two in enumerate(faults):
            for rows in ((3, 4), (4, 3), (3, 3)):
                lie = good.copy()
                for row, (field, value) in zip(rows, (one, two)):
                    lie.records[row][0][field] = value
                paths.append(tmp_path / f"{first}_{second}_{rows}")
                paths[-1].write_bytes(lie.build())
        for row in range(len(good.records)):
            for field in ("offset", "stored_bytes"):
                lie = good.copy()
                lie.records[3][0][one[0]] = one[1]

                def change(entries, header, foot, row=row, field=field):
                    entries[row][field] += 64
                    header["payload_crc32"] = zlib.crc32(entries.tobytes())
                lie.lie_in_index = change
                paths.append(tmp_path / f"{first}_{row}_{field}")
                paths[-1].write_bytes(lie.build())
    agree(paths)


def test_same_verdict_on_translated_line_ends(tmp_path):
    good = tiny(tmp_path / "good.spool")
    paths = []
    for begin in (b"\x89SPL\n", b"\x89SPL\n\x1a\n", b"\x89SPL\r\r\n", b"\x89SPL\r\x1a\r", b"\x89SPL\r", b"\x89SPL\r\n\x1a\n", b"\x89SP"):
        for length in (len(begin), 40, 63, 64, 65, 200):
            paths.append(tmp_path / f"{len(paths)}.bad")
            paths[-1].write_bytes((begin + good[8:])[:length])
    agree(paths)


def test_same_verdict_on_random_damage(tmp_path):
    rng = np.random.default_rng(17)
    paths = []
    for number in range(1000):
        good = bytearray(tiny(tmp_path / "good.spool", compress=bool(number % 2)))
        kind, at = int(rng.integers(0, 5)), int(rng.integers(0, len(good)))
        if kind == 0:
            good[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            del good[at:]
        elif kind == 2:
            good[at:at + 64] = rng.bytes(len(good[at:at + 64]))
        elif kind == 3:
            del good[at:at + int(rng.integers(1, 200))]
        else:
            good[at:at] = bytes(int(rng.integers(1, 200)))
        paths.append(tmp_path / f"{number}.bad")
        paths[-1].write_bytes(good)
    agree(paths)


def test_same_verdict_on_meta(tmp_path):
    texts = [b"{}", b"{", b"[]", b" {}", b"\xef\xbb\xbf{}", b"{}x", b"{} ", b"{'a':1}", b'{"a":NaN}', b'{"a":1e999}', b'{"a":1e-999}',
             b'{"a":' + b"9" * 400 + b"}", b'{"a":' + b"9" * 300 + b"}", b'{"a":"\xff"}', b'{"a":"\\ud800"}', b'{"a":"\\ud83d\\ude00"}',
             b'{"\\udc00":1}', b'{"a":01}', b'{"a":1,}', b'{"a":-0}', b'{"a":1.}', b'{"a":.5}', b'{"a":+1}', b'{"a":"\n"}', b'{"a":"\x7f"}',
             b'{"a":1,"a":2}', b'{"a":"\\x41"}', b'{"a":tru}', b'{/**/}', b'{"a":"\xed\xa0\x80"}', b'{"a":"\xc0\x80"}', b'{"a":"\\u0000"}',
             b'{"a":"\\ud800","a":1}', b'{"a":["\\ud800"],"a":1}', b'{"b":[{"\\udc00":1}],"b":1}', b'{"a":"[[\\"[[","a":1}',
             b'{"a":"\0"}', b'{"":{}}', b'{"a":1.7976931348623159e308}', b'{"a":1.7976931348623157e308}']
    texts += [b'{"a":' + b"[" * depth + b"]" * depth + b"}" for depth in (62, 63, 64, 65, 3000, 200000)]
    texts += [b'{"a":' + b"[" * depth + b"]" * depth + b',"a":1}' for depth in (63, 64)]
    good = Container(tiny(tmp_path / "good.spool"))
    paths = []
    for number, text in enumerate(texts):
        lie = good.copy()
        lie.records[2][0]["stored_bytes"] = lie.records[2][0]["raw_bytes"] = len(text)
        lie.records[2][1] = text
        paths.append(tmp_path / f"meta{number}")
        paths[-1].write_bytes(lie.build())
    agree(paths)


def test_same_verdict_on_mutated_golden_files(tmp_path):
    """A share of what `tools/dev.sh trust fuzz whole` runs a million times."""
    accepted = sum(agree(damaged_golden_files(tmp_path, batch)) for batch in range(200 if WHOLE else 4))
    assert accepted > 100  # not all are refused, so samples are compared, too


def test_killed_numpy_writer_loses_at_most_the_unfinished_record(tmp_path):
    """X4: acknowledged blocks are in the recovered file, bit for bit."""
    rng = np.random.default_rng(5)
    samples = rng.random((16, 16, 64, 3), np.float32)
    recovered = 0
    for number in range(1000 if WHOLE else 40):
        path, out = tmp_path / f"{number}.spool", tmp_path / f"{number}.out"
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                writer = spool.Writer(path, 16, 16, 64, {"radiance": ("f4", "RGB")}, tile_size=8, block_spp=1)
                for s in range(64):
                    for tile in range(4):
                        y, x = tile // 2 * 8, tile % 2 * 8
                        writer.write_block(0, tile, s, np.ascontiguousarray(samples[y:y + 8, x:x + 8, s:s + 1].transpose(3, 0, 1, 2)))
                        os.write(writing, b"x")
            finally:
                os._exit(0)
        os.close(writing)
        wanted, acknowledged = int(rng.integers(0, 250)), 0
        while acknowledged < wanted:
            got = os.read(reading, wanted - acknowledged)
            if not got:
                break
            acknowledged += len(got)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        while got := os.read(reading, 4096):
            acknowledged += len(got)
        os.close(reading)
        partial = tmp_path / f"{number}.spool.partial"
        answer = tool("recover", partial, out)[0].split()
        if answer[0] not in ("0", "4"):
            assert acknowledged == 0, answer
            continue
        if not out.exists():
            assert acknowledged == 0
            continue
        recovered += 1
        with spool.open(out) as dump:
            blocks = dump.blocks()
            assert acknowledged <= len(blocks) <= acknowledged + 1
            for group, tile, s in blocks:
                y, x = tile // 2 * 8, tile % 2 * 8
                assert np.array_equal(dump.block(group, tile, s), samples[y:y + 8, x:x + 8, s:s + 1].transpose(3, 0, 1, 2))
        for done in (partial, out):
            done.unlink()
    assert recovered > (900 if WHOLE else 30)
