"""Several processes, one output: of equal process ids, killed, at the same time."""
import fcntl
import os
import pathlib
import random
import signal
import subprocess
import time

import pytest

from conftest import PROGRAM, samples, write_dump
from results_comparison import assert_same_results

ROUNDS = int(os.environ.get("SPOOL_KILLS", "3"))
PLAN = """
recordings = ["scene.spool"]
spp = [2, 4]
replicates = 2
pictures = {pictures}
samplers = ["uniform", "multiscale"]
filters = ["box", "gaussian"]
"""


@pytest.fixture
def plan(dump, tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(PLAN.format(pictures="true"))
    return path


def alone():
    """A command prefix that gives every process the same id, as a container does; empty where that is not allowed."""
    for prefix in (["unshare", "--pid", "--fork"], ["unshare", "--user", "--map-root-user", "--pid", "--fork"]):
        probe = subprocess.run([*prefix, "sh", "-c", "echo $$"], capture_output=True, text=True)
        if probe.returncode == 0 and probe.stdout.strip() == "1":
            return prefix
    return []


def leftovers(folder):
    return [path for path in folder.rglob("*") if path.name.endswith((".partial", ".scratch"))]


@pytest.mark.skipif(not alone(), reason="SKIPPED: no process namespaces here")
def test_shards_of_equal_process_ids_do_not_meet(good, plan, tmp_path):
    good("evaluate", plan, "-o", "whole")
    for turn in range(ROUNDS):
        shards = [subprocess.Popen([*alone(), PROGRAM, "evaluate", plan, "--shard", f"{i}/4", "-o", tmp_path / f"r{turn}"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for i in range(4)]
        errors = [shard.communicate(timeout=120)[1] for shard in shards]
        assert [shard.returncode for shard in shards] == [0] * 4, errors
        assert not leftovers(tmp_path / f"r{turn}")
        good("evaluate", plan, "--merge", "-o", f"r{turn}")
        assert_same_results(tmp_path / "whole", tmp_path / f"r{turn}", images=True)


def test_two_runs_of_one_folder_both_end_well(good, plan, tmp_path):
    good("evaluate", plan, "-o", "whole")
    for turn in range(4 * ROUNDS):
        folder = tmp_path / f"r{turn}"
        runs = [subprocess.Popen([PROGRAM, "evaluate", plan, "-o", folder], stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, text=True) for _ in range(3)]
        errors = [run.communicate(timeout=120)[1] for run in runs]
        assert [run.returncode for run in runs] == [0] * 3, errors
        assert_same_results(tmp_path / "whole", folder, images=True)


def test_what_killed_runs_left_is_swept_and_what_others_write_is_not(good, plan, tmp_path):
    good("evaluate", plan, "-o", "whole", "--no-pictures")
    folder, chance, torn = tmp_path / "r", random.Random(3), 0
    for _ in range(8 * ROUNDS):
        victim = subprocess.Popen([PROGRAM, "evaluate", plan, "-o", folder, "--no-pictures", "--force"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.0, 0.4))
        victim.kill()
        victim.wait()
        torn += bool(leftovers(folder)) if folder.exists() else 0
    # As a run that was killed while it wrote leaves them, in each place where runs write.
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    (folder / "cells").mkdir(exist_ok=True)
    for place in (folder, folder / "cells", folder / "pictures"):
        (place / "results.csv.spool-abcdefgh.partial").write_text("half of a table")
    alive = folder / "cells" / "0123.json.spool-abcdefgi.partial"
    with open(alive, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        good("evaluate", plan, "-o", folder, "--no-pictures")
        assert leftovers(folder) == [alive]
    good("evaluate", plan, "-o", folder, "--no-pictures")
    assert not leftovers(folder)
    assert_same_results(tmp_path / "whole", folder)


def test_a_shard_leaves_young_files_of_other_machines_alone(good, plan, tmp_path):
    good("evaluate", plan, "--shard", "0/2", "-o", "r", "--no-pictures")
    young, old = (tmp_path / "r" / "cells" / f"x.json.spool-abcdefg{letter}.partial" for letter in "ab")
    for path in (young, old):
        path.write_text("half")
    os.utime(old, (time.time() - 7200,) * 2)
    good("evaluate", plan, "--shard", "1/2", "-o", "r", "--no-pictures")
    assert leftovers(tmp_path) == [young]


COMMANDS = {
    "npz": ["convert", "big.spool", "--to", "npz", "-o", "out/x"],
    "bcd": ["convert", "big.spool", "--to", "bcd", "-o", "out/x"],
    "deep-exr": ["convert", "big.spool", "--to", "deep-exr", "-o", "out/x"],
    "image": ["reconstruct", "big.spool", "--filter", "box", "-o", "out/x"],
    "counts": ["replay", "big.spool", "--sampler", "uniform", "--spp", "4", "-o", "out/x"],
    "synth": ["synth", "scene_s", "--size", "192", "--samples", "32", "-o", "out/x"],
    "recover": ["recover", "big.spool", "out/x"],
    "pack": ["pack", "--from", "npz", "big.npz", "-o", "out/x"],
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("force", [False, True])
def test_of_two_writers_of_one_output_one_wins_and_the_other_says_so(good, tmp_path, command, force):
    radiance, _ = samples(64, 64, 32)
    write_dump(tmp_path / "big.spool", radiance)
    if command == "pack":
        good("convert", "big.spool", "--to", "npz", "-o", "big.npz")
    (tmp_path / "out").mkdir()
    words = [*COMMANDS[command], *(["--force"] if force else [])]
    good(*words)
    whole, outcomes = (tmp_path / "out" / "x").read_bytes(), []
    for _ in range(ROUNDS):
        if not force:
            (tmp_path / "out" / "x").unlink()
        writers = [subprocess.Popen([*alone(), PROGRAM, *words], cwd=tmp_path, stdout=subprocess.DEVNULL,
                                    stderr=subprocess.PIPE, text=True) for _ in range(3)]
        errors = [writer.communicate(timeout=120)[1] for writer in writers]
        codes = sorted(writer.returncode for writer in writers)
        outcomes += codes
        # 2: it came when the other had finished and nothing was forced.
        assert codes[0] == 0 and set(codes) <= ({0, 3} if force else {0, 2, 3}), errors
        assert codes.count(0) == 1 or force, errors  # one after the other, each may replace the last
        assert len((tmp_path / "out" / "x").read_bytes()) == len(whole)
        if command not in ("synth", "recover", "pack"):  # these carry a uuid of their own
            assert (tmp_path / "out" / "x").read_bytes() == whole
        else:
            assert good("check", "out/x")
        assert [path.name for path in (tmp_path / "out").iterdir()] == ["x"]
    assert force or max(outcomes) > 0


def is_locked(folder):
    """Whether somebody is between looking at the target and renaming: others wait for him for a while only."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return False
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)


def stop(process):
    """The signal is only sent when send_signal returns: a busy machine lets the process write on for a while."""
    process.send_signal(signal.SIGSTOP)
    while pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "TZ":
        pass


def stopped_while_writing(words, folder):
    """A writer that stands still (SIGSTOP) with its temporary file begun, and not yet about to rename it."""
    for _ in range(100):
        writer = subprocess.Popen([PROGRAM, *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while writer.poll() is None and not leftovers(folder / "out"):
            pass
        stop(writer)
        if writer.poll() is None and leftovers(folder / "out") and not is_locked(folder / "out"):
            return writer
        writer.send_signal(signal.SIGCONT)
        assert writer.wait(120) == 0
    raise AssertionError("no writer was met while it wrote")


@pytest.mark.parametrize("command", [c for c in COMMANDS if c not in ("image", "counts")])  # these write in an instant
def test_of_two_forced_writers_at_one_time_the_slower_says_so(good, run, tmp_path, command):
    radiance, _ = samples(128, 128, 64)
    write_dump(tmp_path / "big.spool", radiance)
    if command == "pack":
        good("convert", "big.spool", "--to", "npz", "-o", "big.npz")
    (tmp_path / "out").mkdir()
    words = [*COMMANDS[command], "--force"]
    good(*words)
    slow = stopped_while_writing(words, tmp_path)
    fast = run(*words)
    quick = (tmp_path / "out" / "x").read_bytes()
    slow.send_signal(signal.SIGCONT)
    error = slow.communicate(timeout=120)[1]
    assert sorted([slow.returncode, fast.code]) == [0, 3], (error, fast.err)
    said = error if slow.returncode else fast.err
    assert said.count("\n") == 1 and "out/x" in said and "another" in said, said
    if slow.returncode:
        assert (tmp_path / "out" / "x").read_bytes() == quick
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["x"]


def holds_a_nameless_file(process, folder):
    """An exporter lays out what does not fit memory in a file whose name is gone at once."""
    try:
        links = [os.readlink(link) for link in pathlib.Path(f"/proc/{process.pid}/fd").iterdir()]
    except OSError:  # closed or ended meanwhile
        return False
    return any(link.startswith(str(folder)) and link.endswith("(deleted)") for link in links)


def test_an_export_that_was_overtaken_while_it_unpacked_says_so(good, run, tmp_path):
    radiance, _ = samples(192, 192, 64)
    write_dump(tmp_path / "big.spool", radiance)
    (tmp_path / "out").mkdir()
    words = [*COMMANDS["deep-exr"], "--force"]
    good(*words)
    slow = subprocess.Popen([PROGRAM, *words], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while not holds_a_nameless_file(slow, tmp_path / "out"):
        assert slow.poll() is None
    stop(slow)
    good(*words)
    slow.send_signal(signal.SIGCONT)
    error = slow.communicate(timeout=120)[1]
    assert slow.returncode == 3 and "another process wrote it meanwhile" in error, error


SETS = {"deep-exr": "out/x.exr", "exr-folder": "out", "bcd-stats": "out/x", "oidn": "out"}


@pytest.mark.parametrize("kind", SETS)
def test_of_a_set_that_cannot_be_written_the_old_one_stays_whole(good, run, tmp_path, kind):
    radiance, _ = samples(16, 16, 8)
    for name, factor in (("one", 1), ("two", 2)):
        write_dump(tmp_path / f"{name}.spool", factor * radiance, reference=0.9 * factor * radiance.mean(2))
    (tmp_path / "out").mkdir()
    words = ["--to", kind, "-o", SETS[kind], *(["--set", "export.name=x"] if kind == "oidn" else [])]
    good("convert", "one.spool", *words)
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    full = subprocess.run(["sh", "-c", 'ulimit -f 1; trap "" XFSZ; exec "$@"', "sh", PROGRAM, "convert", "two.spool", *words, "--force"],
                          cwd=tmp_path, capture_output=True, text=True)
    assert full.returncode == 3 and full.stderr.count("\n") == 1, full.stderr
    assert kind == "deep-exr" or "partial" not in full.stderr  # that of deep-exr is a file without a name
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before
    good("convert", "two.spool", *words, "--force")
    after = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert set(after) == set(before) and not any(after[name] == before[name] for name in before)


@pytest.mark.parametrize("kind", SETS)
def test_an_ended_export_leaves_no_part_of_a_set(good, tmp_path, kind):
    radiance, _ = samples(128, 128, 64)
    write_dump(tmp_path / "big.spool", radiance, reference=0.9 * radiance.mean(2))
    (tmp_path / "out").mkdir()
    export = subprocess.Popen([PROGRAM, "convert", "big.spool", "--to", kind, "-o", SETS[kind]], cwd=tmp_path,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while export.poll() is None and not leftovers(tmp_path / "out"):
        pass
    export.send_signal(signal.SIGTERM)
    assert export.wait(60) in (0, 143)
    assert export.returncode == 0 or not list((tmp_path / "out").iterdir())


def own_inputs(folder):
    """Commands that would write onto what they read, and the file."""
    radiance, _ = samples(16, 16, 8)
    write_dump(folder / "a.exr", radiance, reference=0.9 * radiance.mean(2))
    write_dump(folder / "x_pieces.exr", radiance, reference=0.9 * radiance.mean(2))
    write_dump(folder / "sample_0001.exr", radiance, reference=0.9 * radiance.mean(2))
    write_dump(folder / "p_cov.exr", radiance, reference=0.9 * radiance.mean(2))
    os.link(folder / "a.exr", folder / "b.exr")
    os.link(folder / "a.exr", folder / "a.png")
    yield ["reconstruct", "a.exr", "--filter", "box", "-o", "a.exr"], "a.exr"
    yield ["reconstruct", "x_pieces.exr", "--filter", "box", "-o", "x.exr"], "x_pieces.exr"
    yield ["replay", "a.exr", "--sampler", "uniform", "--spp", "2", "-o", "b.exr"], "a.exr"
    for kind in ("npz", "bcd", "deep-exr"):
        yield ["convert", "a.exr", "--to", kind, "-o", "./a.exr"], "a.exr"
    yield ["convert", "a.exr", "--to", "bcd-stats", "-o", "a"], "a.exr"
    yield ["convert", "p_cov.exr", "--to", "bcd-stats", "-o", "p"], "p_cov.exr"
    yield ["convert", "sample_0001.exr", "--to", "exr-folder", "-o", "."], "sample_0001.exr"
    yield ["recover", "a.exr", "b.exr"], "a.exr"


def test_no_output_is_an_input(run, good, tmp_path):
    for words, name in own_inputs(tmp_path):
        before = (tmp_path / name).read_bytes()
        done = run(*words, "--force")
        assert done.code == 2 and "output is the input" in done.err and done.err.count("\n") == 1, (words, done.err)
        assert (tmp_path / name).read_bytes() == before and not leftovers(tmp_path)


def test_no_output_is_an_image_or_a_foreign_file_that_is_read(run, good, tmp_path):
    radiance, _ = samples(16, 16, 8)
    write_dump(tmp_path / "a.spool", radiance, reference=0.9 * radiance.mean(2))
    good("reconstruct", "a.spool", "--filter", "box", "-o", "i.exr")
    good("reconstruct", "a.spool", "--filter", "box", "--spp", "2", "-o", "r.exr")
    good("replay", "a.spool", "--sampler", "uniform", "--spp", "2", "-o", "n.exr")
    good("convert", "a.spool", "--to", "npz", "-o", "a.npz")
    good("convert", "a.spool", "--to", "exr-folder", "-o", "f")
    good("convert", "a.spool", "--to", "deep-exr", "-o", "d.exr")
    good("evaluate", "a.spool", "--spp", "2", "--replicates", "2", "--no-pictures", "-o", "results")
    (tmp_path / "a.passes").mkdir()
    (tmp_path / "a.passes" / "pass.json").write_text("{}")
    os.link(tmp_path / "i.exr", tmp_path / "i.png")
    os.link(tmp_path / "i.exr", tmp_path / "i.html")
    for words, name in ((["reconstruct", "a.spool", "--filter", "box", "--selection", "n.exr", "-o", "n.exr"], "n.exr"),
                        (["reconstruct", "a.spool", "--filter", "image:i.exr", "-o", "i.exr"], "i.exr"),
                        (["metrics", "i.exr", "r.exr", "--error-map", "i.exr"], "i.exr"),
                        (["metrics", "i.exr", "r.exr", "--error-map", "r.exr"], "r.exr"),
                        (["metrics", "i.exr", "r.exr", "--mask", "m=n.exr", "--error-map", "n.exr"], "n.exr"),
                        (["picture", "i.exr", "-o", "i.png"], "i.exr"), (["picture", "r.exr", "--like", "i.exr", "-o", "i.png"], "i.exr"),
                        (["show", "a=i.exr", "r.exr", "-o", "i.html"], "i.exr"), (["show", "r.exr", "--reference", "i.exr", "-o", "i.html"], "i.exr"),
                        (["report", "results", "-o", "results/results.csv"], "results/results.csv"),
                        (["pack", "a.passes", "-o", "a.passes/pass.json"], "a.passes/pass.json"),
                        (["pack", "--from", "npz", "a.npz", "-o", "a.npz"], "a.npz"),
                        (["pack", "--from", "exr-folder", "f", "-o", "f/sample_0003.exr"], "f/sample_0003.exr"),
                        (["pack", "--from", "deep-exr", "d.exr", "-o", "d.pixel.exr"], "d.pixel.exr")):
        before = (tmp_path / name).read_bytes()
        done = run(*words, "--force")
        assert done.code == 2 and "output is the input" in done.err and done.err.count("\n") == 1, (words, done.err)
        assert (tmp_path / name).read_bytes() == before and not leftovers(tmp_path)


@pytest.mark.parametrize("words", [["convert", "a.spool", "--to", "npz", "-o", "link"], ["convert", "a.spool", "--to", "bcd-stats", "-o", "link"]])
def test_a_link_to_nothing_is_there(run, tmp_path, words):
    write_dump(tmp_path / "a.spool", samples(16, 16, 8)[0])
    for name in ("link", "link_hist.exr"):
        (tmp_path / name).symlink_to("nowhere")
    done = run(*words)
    assert done.code == 2 and ": exists: choose another name" in done.err and not leftovers(tmp_path), done.err
