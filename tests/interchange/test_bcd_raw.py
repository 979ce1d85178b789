import struct

import numpy as np
import pytest
import spool

from conftest import run_jobs


def run(*job):
    return run_jobs(job)[0]


def raw(array, /, **changes):
    """The file by numpy alone, from [y][x][s][c]."""
    header = dict(zip(("version", "height", "width", "samples", "channels"), (1, *array.shape)), **changes)
    order = ("version", "width", "height", "samples", "channels")
    return struct.pack("<5i", *(header[name] for name in order)) + array.astype("<f4").tobytes()


@pytest.mark.parametrize("seed", range(20))
def test_samples_are_bit_exact_both_ways(tmp_path, seed):
    rng = np.random.default_rng(seed)
    height, width, spp = (int(value) for value in rng.integers(1, 30, 3))
    channels = 3 + seed % 2
    samples = rng.integers(0, 256, height * width * spp * channels * 4, np.uint8).view("<f4").reshape(height, width, spp, channels)
    source, dump_path, target = tmp_path / "a.raw", tmp_path / "a.spool", tmp_path / "b.raw"
    source.write_bytes(raw(samples))
    options = ["exchangeable"] if seed % 3 == 0 else []
    results = run_jobs(("import bcd", source, dump_path, "tile=8", f"block={rng.integers(0, 9)}", *options),
                       ("export bcd", dump_path, target))
    assert [code for code, _ in results] == [0, 0]
    assert spool.check(dump_path).ok
    expected = np.ascontiguousarray(samples[..., :3])
    with spool.open(dump_path) as dump:
        assert dump.read("radiance").tobytes() == expected.tobytes()
        assert dump.sample_order == ("exchangeable" if options else "renderer")
        record = dump.meta["import"]
        assert record["format"] == "bcd-raw" and record["independent"] == "unknown"
        assert record["dropped"] == (["alpha"] if channels == 4 else [])
    assert target.read_bytes() == raw(expected)


def test_half_radiance_is_widened_and_other_layers_are_named(tmp_path):
    samples = np.random.default_rng(1).random((9, 5, 3, 3)).astype("f2")
    spool.write(tmp_path / "a.spool", samples, depth=samples[..., 0], tile_size=8, block_spp=2)
    code, notes = run("export bcd", tmp_path / "a.spool", tmp_path / "a.raw")
    assert code == 0 and notes.startswith("depth is not written")
    assert (tmp_path / "a.raw").read_bytes() == raw(samples)


SAMPLES = np.random.default_rng(2).random((4, 3, 2, 3), np.float32)


@pytest.mark.parametrize("code, words, data", [
    (4, "hold no header", b""), (4, "hold no header", raw(SAMPLES)[:19]),
    (1, "not a BCD raw file", raw(SAMPLES) + b"\0"), (1, "is a zip archive, a BCD raw file is needed", b"PK\3\4" * 30),
    (1, "not a BCD raw file", raw(SAMPLES, width=2))])
def test_other_files_are_refused(tmp_path, code, words, data):
    path = tmp_path / "a.raw"
    path.write_bytes(data)
    found, message = run("import bcd", path, tmp_path / "a.spool")
    assert found == code and words in message and message.startswith(str(path))
    assert not (tmp_path / "a.spool").exists()


def test_every_header_field_is_bounded(tmp_path):
    jobs = []
    for field in ("width", "height", "samples", "channels"):
        for value in (0, 1, -1, 2, 5, 65537, 2**31 - 1, -2**31):
            path = tmp_path / f"{len(jobs)}.raw"
            path.write_bytes(raw(SAMPLES, **{field: value}))
            jobs.append(("import bcd", path, path.with_suffix(".spool")))
    for (_, path, _), (code, message) in zip(jobs, run_jobs(*jobs)):
        expected = struct.unpack("<5i", path.read_bytes()[:20])
        assert code in (0, 1, 4)
        assert (code == 0) == (expected == (1, 3, 4, 2, 3)), message


def test_no_truncation_is_taken(tmp_path):
    good = raw(SAMPLES)
    jobs = []
    for size in range(len(good)):
        path = tmp_path / f"{size}.raw"
        path.write_bytes(good[:size])
        jobs.append(("import bcd", path, path.with_suffix(".spool")))
    for (_, path, _), (code, message) in zip(jobs, run_jobs(*jobs)):
        assert code == 4
        size = path.stat().st_size
        if size >= 20:
            assert f"cut in row {(size - 20) // 72}" in message
    assert not list(tmp_path.glob("*.spool"))


def test_version_is_checked_by_nobody(tmp_path):
    path = tmp_path / "a.raw"
    path.write_bytes(raw(SAMPLES, version=7))
    assert run("import bcd", path, tmp_path / "a.spool")[0] == 0


def test_holes_and_existing_files(tmp_path):
    with spool.Writer(tmp_path / "a.spool", 8, 8, 2, {"radiance": ("f4", "RGB")}, tile_size=8):
        pass
    code, message = run("export bcd", tmp_path / "a.spool", tmp_path / "a.raw")
    assert code == 1 and "no radiance in tile 0" in message
    spool.write(tmp_path / "b.spool", SAMPLES)
    (tmp_path / "a.raw").write_bytes(b"precious")
    assert run("export bcd", tmp_path / "b.spool", tmp_path / "a.raw")[0] == 2
    assert (tmp_path / "a.raw").read_bytes() == b"precious"
    assert run("export bcd", tmp_path / "b.spool", tmp_path / "a.raw", "force")[0] == 0
    assert (tmp_path / "a.raw").read_bytes() == raw(SAMPLES)
