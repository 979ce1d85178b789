"""File systems without locks, disks that fail at hints, and what a killed writer leaves."""

import errno
import fcntl
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import spool
from conftest import PROGRAM

HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def faulty(tmp_path_factory):
    library = tmp_path_factory.mktemp("faulty") / "faulty_system.so"
    subprocess.run(["c++", "-shared", "-fPIC", "-O1", "-o", str(library), str(HERE / "faulty_system.cpp"), "-ldl"], check=True)

    def environment(**faults):
        return {**os.environ, "LD_PRELOAD": str(library), "ASAN_OPTIONS": "verify_asan_link_order=0",
                **{f"FAULT_{name}": str(value) for name, value in faults.items()}}
    return environment


def arrays(path, size=8):
    np.savez(path, radiance=np.random.default_rng(1).random((size, size, 4, 3), dtype="f4"))
    return path


def unfinished(folder):
    return sorted(path.name for path in Path(folder).rglob("*.partial"))


WRITERS = {
    "pack": ["pack", "--from", "npz", "a.npz", "--set", "import.layout=HWSC", "-o", "p.spool"],
    "synth": ["synth", "scene_s", "--size", "16x16", "--samples", "8", "-o", "p.spool"],
    "recover": ["recover", "scene.spool", "p.spool"],
    "replay": ["replay", "scene.spool", "--sampler", "uniform", "--spp", "4", "-o", "n.exr"],
    "evaluate": ["evaluate", "scene.spool", "--spp", "4", "--filters", "box", "--replicates", "2", "-o", "r"],
}


@pytest.mark.parametrize("error", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL])
@pytest.mark.parametrize("verb", WRITERS)
def test_a_file_system_without_locks_is_written_to(run, faulty, dump, tmp_path, verb, error):
    arrays(tmp_path / "a.npz")
    done = run(*WRITERS[verb], "-q", env=faulty(FLOCK=error))
    assert done.code == 0, done.err
    assert unfinished(tmp_path) == []
    if verb in ("pack", "synth", "recover"):
        assert run("check", "p.spool").code == 0
        assert run(*WRITERS[verb], "-q", "--force", env=faulty(FLOCK=error)).code == 0


def test_the_numpy_writer_needs_no_locks(faulty, tmp_path):
    script = ("import numpy, spool; spool.write('p.spool', radiance=numpy.ones((4, 4, 2, 3), 'f4'), sample_order='exchangeable')")
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=faulty(FLOCK=errno.ENOLCK), check=True)
    with spool.open(tmp_path / "p.spool") as dump:
        assert dump.complete and unfinished(tmp_path) == []


@pytest.mark.parametrize("hint", ["/proc/self/cgroup", "/proc/meminfo", "/proc/self/statm", "/proc/self/status", "/proc/self/cmdline", "/proc/cpuinfo",
                                  "/sys/fs/cgroup"])
def test_a_hint_that_cannot_be_read_decides_nothing(run, faulty, dump, hint):
    done = run(*WRITERS["evaluate"], "-q", env=faulty(READ=hint))
    assert done.code == 0, done.err


def test_a_file_that_cannot_be_read_is_named(run, good, faulty, dump, tmp_path):
    good(*WRITERS["evaluate"], "-q")
    run("evaluate", "r/plan.toml", "-o", "s", "-q", env=faulty(READ="plan.toml")).failed_with(3, "plan.toml")
    cell = next((tmp_path / "r" / "cells").iterdir())
    run("evaluate", "r/plan.toml", "--merge", "--from", "r", "-o", "t", "-q", env=faulty(READ=cell.name)).failed_with(3, cell.name)
    cell.unlink()
    os.mkfifo(cell)
    run("evaluate", "r/plan.toml", "--merge", "--from", "r", "-o", "u", "-q").failed_with(3, cell.name)


def test_a_file_that_cannot_be_looked_at_is_not_said_to_be_written_by_another(run, faulty, dump, tmp_path):
    arrays(tmp_path / "a.npz")
    for verb in ("pack", "synth", "recover"):
        done = run(*WRITERS[verb], "-q", env=faulty(FSTAT=".partial"))
        done.failed_with(3, "p.spool", "Input/output error")
        assert "another process" not in done.err and unfinished(tmp_path) == []


def test_what_a_killed_writer_left_is_replaced_by_the_same_command(run, tmp_path):
    arrays(tmp_path / "a.npz", 512)
    for attempt in range(20):
        process = subprocess.Popen([PROGRAM, *WRITERS["pack"], "-q"], cwd=tmp_path)
        while process.poll() is None and not unfinished(tmp_path):
            time.sleep(0.0005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        if unfinished(tmp_path):
            break
        (tmp_path / "p.spool").unlink(missing_ok=True)
    assert unfinished(tmp_path) and not (tmp_path / "p.spool").exists()
    done = run(*WRITERS["pack"], "-q")
    assert done.code == 0, done.err
    assert unfinished(tmp_path) == [] and run("check", "p.spool").code == 0


def test_what_may_be_a_recording_is_kept(run, dump, tmp_path):
    arrays(tmp_path / "a.npz")
    begun = tmp_path / "p.spool.partial"
    begun.write_bytes(dump.read_bytes()[:2048])
    for verb in ("pack", "synth", "recover"):
        run(*WRITERS[verb], "-q").failed_with(2, "p.spool.partial", "unfinished")
        assert begun.read_bytes() == dump.read_bytes()[:2048] and unfinished(tmp_path) == [begun.name]
    assert run(*WRITERS["pack"], "-q", "--force").code == 0 and unfinished(tmp_path) == []


def test_two_at_once_do_not_share_a_file(run, tmp_path):
    arrays(tmp_path / "a.npz")
    for name in ("p.spool.remade.partial", "p.spool.partial"):
        with open(tmp_path / name, "wb") as other:
            fcntl.flock(other, fcntl.LOCK_EX)
            run(*WRITERS["pack"], "-q", "--force").failed_with(3, "another process is writing it")
        (tmp_path / name).unlink()
