"""Packed passes: the same recording as plain ones, and passes that go when it has them. No Blender."""
import os
import subprocess

import pytest
from conftest import ROOT

np = pytest.importorskip("numpy")
pytest.importorskip("zstandard")

from dumps.cycles import packed_pass
import spool
from dumps.verify.content_hash import content_hash
from dumps.cycles.pass_folder import PassFolder

SPOOL = os.environ.get("SPOOL", str(ROOT / "build" / "release" / "spool"))
WIDTH, HEIGHT, SPP, BATCHES = 7, 3 * packed_pass.PIECE_ROWS - 50, 20, 3      # pieces of full and of fewer rows
NAMES = ["radiance.R", "radiance.G", "radiance.B", "depth.Z"]


def passes(folder, packed, monkeypatch):
    if not packed:
        monkeypatch.setattr(packed_pass, "zstandard", None)
    rng = np.random.default_rng(1)
    recording = {"width": WIDTH, "height": HEIGHT, "mode": "iid", "seed": 1,
                 "channels": [{"name": name, "dtype": "f16" if name == "depth.Z" else "f32"} for name in NAMES]}
    there = PassFolder(str(folder), recording)
    for kind, count, planes in (("pass", SPP, 4), ("reference", BATCHES, 3)):
        for index in range(count):
            data = rng.gamma(0.5, 1, (planes, HEIGHT, WIDTH)).astype("<f4")
            data[1:] = np.rint(64 * data[1:]) / 64              # compresses; the first plane hardly
            there.add(kind, index, data.tobytes(), {"seed": len(there.entries["pass"]) + 1000 * (kind == "reference") + index,
                                                    "sample_index": 1, "samples": 1 if kind == "pass" else 4})
    monkeypatch.undo()
    return there


def pack(folder, out, *options):
    return subprocess.run([SPOOL, "pack", folder, "-o", out, *options], capture_output=True, text=True)


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
@pytest.mark.parametrize("removed", [(), ("--remove-passes",)])
def test_packed_passes_make_the_same_recording(tmp_path, monkeypatch, removed):
    plain, small = (passes(tmp_path / name, name == "packed", monkeypatch) for name in ("plain", "packed"))
    files = [line["file"] for entries in small.entries.values() for line in entries.values()]
    sizes = [sum(os.path.getsize(tmp_path / name / file) for file in files) for name in ("plain", "packed")]
    assert sizes[1] < 0.95 * sizes[0] and small.batch(1) == plain.batch(1)
    batches = [np.frombuffer(plain.batch(index), "<f4").reshape(3, HEIGHT, WIDTH) for index in range(BATCHES)]
    for name in ("plain", "packed"):
        done = pack(tmp_path / name, tmp_path / (name + ".spool"), "--compress", *removed)
        assert done.returncode == 0, done.stderr
        assert [os.path.exists(tmp_path / name / file) for file in files] == [not removed] * len(files)
    assert len({content_hash(str(tmp_path / (name + ".spool"))) for name in ("plain", "packed")}) == 1
    with spool.open(tmp_path / "packed.spool") as dump:
        assert dump.spp == SPP and np.allclose(dump.pixel("reference"), np.mean(batches, 0).transpose(1, 2, 0), rtol=1e-6)


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
@pytest.mark.parametrize("harm, words", [
    (lambda data: data[:8], "cut in its table"), (lambda data: b"\xff" * 4 + data[4:], "larger than its rows"),
    (lambda data: data[:-1], "bytes instead of"), (lambda data: data[:-1] + b"\0" + b"x", "bytes instead of"),
    (lambda data: data[:-9] + bytes(9), "CRC-32")])
def test_a_damaged_packed_pass_is_one_line(tmp_path, monkeypatch, harm, words):
    folder = passes(tmp_path / "p", True, monkeypatch)
    path = tmp_path / "p" / folder.entries["pass"][3]["file"]
    path.write_bytes(harm(path.read_bytes()))
    done = pack(tmp_path / "p", tmp_path / "a.spool", "--remove-passes")
    assert done.returncode == 4 and words in done.stderr and path.name in done.stderr and done.stderr.count("\n") == 1, done.stderr
    assert len(list((tmp_path / "p").glob("*.f32"))) == SPP + BATCHES          # nothing was taken


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
def test_passes_that_unpack_to_far_more_are_taken_on_the_users_word_only(tmp_path):
    folder = PassFolder(str(tmp_path / "p"), {"width": 1024, "height": 1024, "mode": "iid", "seed": 1,
                                              "channels": [{"name": name, "dtype": "f32"} for name in NAMES[:3]]})
    for index in range(3):
        folder.add("pass", index, bytes(12 << 20), {"seed": index, "sample_index": 1, "samples": 1})
    assert sum(path.stat().st_size for path in (tmp_path / "p").iterdir()) < 8192
    done = pack(tmp_path / "p", tmp_path / "a.spool")
    assert done.returncode == 1 and "--max-expansion" in done.stderr and not (tmp_path / "a.spool").exists(), done.stderr
    done = pack(tmp_path / "p", tmp_path / "a.spool", "--compress", "--max-expansion", done.stderr.split()[-1])
    assert done.returncode == 0, done.stderr


def test_passes_that_are_not_of_a_folder_are_not_removed(tmp_path):
    done = pack(tmp_path / "a.npz", tmp_path / "a.spool", "--from", "npz", "--remove-passes")
    assert done.returncode == 2 and "--remove-passes" in done.stderr and done.stderr.count("\n") == 1
