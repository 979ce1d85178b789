"""Going on with a stopped recording: with the same wishes, with another reference, after an older recorder, with a damaged file."""
import functools
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import spool
from conftest import RECORD, check_ok, record
from dumps.verify.content_hash import content_hash
from dumps.mitsuba.reference import add_chunk, begun_or_empty, empty_reference

pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

OPTIONS = ["cornell-box", "--size", 32, "--samples", 16, "--chunk-lanes", 4096, "--channels", "radiance"]
PIXELS = 32 * 32


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """The folder of a recording that was killed while it drew 4 samples at a time of a reference of 512."""
    out = tmp_path_factory.mktemp("stopped") / "cut.spool"
    process = subprocess.Popen([sys.executable, RECORD, *map(str, OPTIONS), "-o", str(out), "--reference", "512"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not os.path.exists(str(out) + ".recording/reference.npz"):
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    return str(out) + ".recording"


def go_on(stopped, folder, reference, change=lambda state: state):
    """(path of the file, stderr) of a recording that goes on from a copy; change: of the state of the reference."""
    out = folder / "on.spool"
    shutil.copytree(stopped, str(out) + ".recording")
    path = str(out) + ".recording/reference.npz"
    with np.load(path) as stored:
        state = change({name: stored[name] for name in stored.files})
    np.savez(path, **state)
    return out, check_ok(record(*OPTIONS, "-o", out, "--reference", reference)).stderr


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """whole(reference) -> hash of a recording that was never stopped"""
    @functools.cache
    def hashed(reference):
        out = tmp_path_factory.mktemp("whole") / "whole.spool"
        check_ok(record(*OPTIONS, "-o", out, "--reference", reference))
        return content_hash(str(out))

    return hashed


def without_its_number(state):
    """As recorders left it that did not keep what a reference was begun for."""
    del state["cut"]
    return state


@pytest.mark.parametrize("change", [lambda state: state, without_its_number])
def test_the_same_reference_goes_on_to_the_same_bits(stopped, whole, tmp_path, change):
    out, told = go_on(stopped, tmp_path, 512, change)
    assert told == "" and content_hash(str(out)) == whole(512)


@pytest.mark.parametrize("change, reference", [(lambda state: state, 640), (without_its_number, 18)])
def test_a_larger_reference_goes_on_and_a_smaller_one_begins_anew(stopped, whole, tmp_path, change, reference):
    out, told = go_on(stopped, tmp_path, reference, change)
    anew = "the reference there holds more than --reference %d, or is cut by other --chunk-lanes: it begins anew, the pool is kept"
    assert told == "" if reference > 512 else anew % reference in told
    with spool.open(out) as dump:
        assert dump.meta["reference"]["samples"] == reference
        assert dump.meta["random_numbers"] == {"pool": 16 * PIXELS, "pool_repeated": 0, "reference": reference * PIXELS,
                                               "reference_repeated": 0}
    assert content_hash(str(out)) == whole(reference)


def test_a_state_that_was_cut_otherwise_is_not_gone_on_with():
    """A reference of 64 in chunks of 64, begun; then in chunks of 32, as with fewer lanes."""
    begun, _ = begun_or_empty(None, 64, [(0, 64, (0, 4))], 4, 3)
    assert begun_or_empty(begun, 64, [(0, 64, (0, 4))], 4, 3)[1] is False
    assert begun_or_empty(begun, 64, [(0, 32, (0, 4)), (32, 32, (0, 4))], 4, 3)[1] is True
    assert begun_or_empty(begun, 128, [(0, 64, (0, 4)), (64, 64, (0, 4))], 4, 3)[1] is False
    assert begun_or_empty(begun, 64, [(0, 64, (0, 2)), (0, 64, (2, 4))], 4, 3)[1] is True


def test_a_state_without_its_number_is_taken_by_the_samples_it_holds():
    """One chunk of 32 samples of 3 x 4 pixels: the whole of a reference of 32, the beginning of one in chunks of 32, not of 64."""
    radiance = np.ones((4, 3, 32, 3), "f4")
    radiance[0, 0, 0] = np.nan
    stored = add_chunk(empty_reference(4, 3), radiance, 1.0, (0, 4))
    for parts, useless in (([(0, 32, (0, 4))], False), ([(0, 32, (0, 4)), (32, 32, (0, 4))], False), ([(0, 64, (0, 4))], True)):
        state, found = begun_or_empty(stored, sum(count for _, count, _ in parts), parts, 4, 3)
        assert found == useless and int(state["chunks"]) == (not useless) and state["cut"][0] == sum(part[1] for part in parts)


@pytest.mark.parametrize("name, remedy", [("chunk_00001.npz", "remove it"), ("reference.npz", "remove it"), ("plan.json", "remove the folder")])
@pytest.mark.parametrize("damage", ["cut", "changed"])
def test_a_damaged_file_is_one_line_and_what_to_do_helps(stopped, tmp_path, name, remedy, damage):
    out, folder = tmp_path / "on.spool", tmp_path / "on.spool.recording"
    shutil.copytree(stopped, folder)
    content = (folder / name).read_bytes()
    half = len(content) // 2
    (folder / name).write_bytes(content[:half] if damage == "cut" else content[:half - 20] + b"\xff" * 40 + content[half + 20:])
    result = record(*OPTIONS, "-o", out, "--reference", 512)
    assert result.returncode == 3 and len(result.stderr.strip().splitlines()) == 1, result.stderr
    assert "%s: damaged" % name in result.stderr and "%s and run the same command again" % remedy in result.stderr
    assert not out.exists()
    if name == "chunk_00001.npz":              # found while the file was being written, when it was only changed
        os.remove(folder / name)
        check_ok(record(*OPTIONS, "-o", out, "--reference", 8))


def test_an_unfinished_file_of_somebody_else_is_left_alone(tmp_path):
    out, partial = tmp_path / "on.spool", tmp_path / "on.spool.partial"
    partial.write_text("theirs")
    for _ in range(2):
        result = record(*OPTIONS, "-o", out)
        assert result.returncode == 2 and "on.spool.partial: exists" in result.stderr and partial.read_text() == "theirs"
    partial.unlink()
    check_ok(record(*OPTIONS, "-o", out))


def test_a_recording_killed_while_its_samples_are_tested_goes_on_and_is_tested(tmp_path, whole):
    out = tmp_path / "on.spool"
    options = [*OPTIONS, "-o", out, "--reference", 8]
    process = subprocess.Popen([sys.executable, RECORD, *map(str, options)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not os.path.exists(str(out) + ".recording/whole_1.spool"):
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL and not out.exists()
    check_ok(record(*options))
    assert os.listdir(tmp_path) == ["on.spool"] and content_hash(str(out)) == whole(8)
    with spool.open(out) as dump:
        assert dump.meta["verification"]["holds"] is True


def test_a_whole_file_gives_its_samples_to_another_reference(tmp_path, whole):
    """Killed while the samples were tested: nothing of the pool is traced again, and the file is as one that was never stopped."""
    out, folder = tmp_path / "on.spool", tmp_path / "on.spool.recording"
    options = [*OPTIONS, "-o", out]
    process = subprocess.Popen([sys.executable, RECORD, *map(str, options), "--reference", "16"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    while process.poll() is None and not (folder / "whole_1.spool").exists():
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL and not out.exists() and not list(folder.glob("chunk_*"))
    # Stopped again as soon as the file has given its samples back: all are there before a first one could be traced.
    process = subprocess.Popen([sys.executable, RECORD, *map(str, options), "--reference", "2048"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    while process.poll() is None and (folder / "numbers.json").exists():
        time.sleep(0.001)
    there = list(folder.glob("chunk_*"))
    process.send_signal(signal.SIGKILL)
    assert process.communicate()[1] == "" and len(there) == 4
    check_ok(record(*options, "--reference", 8))
    assert os.listdir(tmp_path) == ["on.spool"] and content_hash(str(out)) == whole(8)
    with spool.open(out) as dump:
        assert dump.meta["random_numbers"]["pool"] == 16 * PIXELS and dump.meta["random_numbers"]["reference_repeated"] == 0
        assert dump.meta["cost_per_sample"] > 0


@pytest.mark.parametrize("reference", [8, 16])
def test_a_file_that_took_some_chunks_and_was_cut_is_made_again(tmp_path, whole, reference):
    """Killed as the first chunk is taken: it is traced once more; so is all that a whole file took, for another reference."""
    out, folder = tmp_path / "on.spool", tmp_path / "on.spool.recording"
    process = subprocess.Popen([sys.executable, RECORD, *map(str, OPTIONS), "-o", str(out), "--reference", "8"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not ((folder / "numbers.json").exists() and not (folder / "chunk_00000.npz").exists()):
        time.sleep(0.0005)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL and not out.exists()
    check_ok(record(*OPTIONS, "-o", out, "--reference", reference))
    assert os.listdir(tmp_path) == ["on.spool"] and content_hash(str(out)) == whole(reference)
