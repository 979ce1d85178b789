"""dumps/record.sh: from a scene to a dump in one command."""
import hashlib
import json
import os
import signal
import subprocess
import time

import pytest
from conftest import ROOT

SPOOL = os.environ.get("SPOOL", str(ROOT / "build" / "release" / "spool"))


def run(*options):
    return subprocess.run([ROOT / "dumps" / "record.sh", *map(str, options)], capture_output=True, text=True,
                          timeout=280, env={**os.environ, "SPOOL": SPOOL})


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
def test_a_scene_becomes_a_checked_dump(tmp_path):
    dump = tmp_path / "chess.spool"
    done = run("chess", "--size", "20x12", "--samples", "4", "--mode", "shift", "--reference", "64", "--compress",
               "-o", dump)
    assert done.returncode == 0, done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["chess.spool"]
    assert subprocess.run([SPOOL, "check", dump], capture_output=True).returncode == 0
    told = subprocess.run([SPOOL, "info", dump, "--json"], capture_output=True, text=True)
    info = json.loads(told.stdout)
    assert (info["samples_per_pixel"], info["reference"]) == (4, True)
    assert info["cost_per_sample"] > 0
    assert info["verified"] is True and info["meta"]["verification"]["findings"]
    again = run("chess", "--size", "20x12", "-o", dump)
    assert again.returncode == 2 and "exists" in again.stderr


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
def test_a_recording_killed_while_its_samples_are_tested_goes_on_and_is_tested(tmp_path):
    dump, passes = tmp_path / "chess.spool", tmp_path / "chess.spool.passes"
    options = ("chess", "--size", "20x12", "--samples", "4", "--reference", "64", "-o", dump)
    process = subprocess.Popen([ROOT / "dumps" / "record.sh", *map(str, options)], env={**os.environ, "SPOOL": SPOOL},
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    while process.poll() is None and not (passes / "whole.spool").exists():
        time.sleep(0.001)
    os.killpg(process.pid, signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL and not dump.exists()
    rendered = (passes / "passes.jsonl").read_bytes()
    done = run(*options, "--keep")
    assert done.returncode == 0, done.stderr
    assert (passes / "passes.jsonl").read_bytes() == rendered and not (passes / "whole.spool").exists()
    told = subprocess.run([SPOOL, "info", dump, "--json"], capture_output=True, text=True)
    assert json.loads(told.stdout)["verified"] is True


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
def test_a_folded_reference_makes_the_same_recording_and_leaves_nothing_else(tmp_path):
    for name, keep in (("folded", ()), ("whole", ("--keep",))):
        done = run("chess", "--size", "20x12", "--samples", "4", "--reference", "128", *keep, "-o", tmp_path / (name + ".spool"))
        assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folded.spool", "whole.spool", "whole.spool.passes"]
    assert len(list((tmp_path / "whole.spool.passes").glob("reference_000??.f32"))) == 64
    hashed = [subprocess.run(["/usr/bin/python3", ROOT / "dumps" / "verify" / "content_hash.py", tmp_path / (name + ".spool")],
                             capture_output=True, text=True, check=True).stdout.split()[0] for name in ("folded", "whole")]
    assert hashed[0] == hashed[1]
    references = [json.loads(subprocess.run([SPOOL, "info", tmp_path / (name + ".spool"), "--json"], capture_output=True,
                                            text=True).stdout)["meta"]["reference"] for name in ("folded", "whole")]
    for reference in references:
        assert reference.pop("cost_per_sample") > 0
    assert references[0] == references[1] and references[0]["samples_per_batch"] == 2 and len(references[0]["seeds"]) == 64


def test_it_finds_the_recorder_by_a_link(tmp_path):
    (tmp_path / "record").symlink_to(ROOT / "dumps/record.sh")
    done = subprocess.run([tmp_path / "record", "chess", "--size", "20x12", "--dry-run"], cwd=tmp_path, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0 and "20x12" in done.stdout + done.stderr, done.stderr


def test_a_missing_blender_is_one_line(tmp_path):
    done = subprocess.run([ROOT / "dumps" / "record.sh", "chess", "-o", tmp_path / "dump.spool"], capture_output=True,
                          text=True, env={**os.environ, "SPOOL": SPOOL, "BLENDER": "no-such-blender"})
    assert done.returncode == 3 and done.stderr.count("\n") == 1
    assert "no-such-blender is not installed: apt-get install blender python3-numpy python3-zstandard" in done.stderr


@pytest.mark.parametrize("kind", ["absent", "folder", "plain file"])
def test_a_program_that_cannot_pack_is_refused_before_anything_renders(kind, tmp_path):
    spool, blender = tmp_path / "spool", tmp_path / "blender"
    if kind == "folder":
        spool.mkdir()
    elif kind == "plain file":
        spool.write_text("")
    blender.write_text("#!/bin/sh\ntouch %s\n" % (tmp_path / "rendered"))
    blender.chmod(0o755)
    done = subprocess.run([ROOT / "dumps" / "record.sh", "chess", "-o", tmp_path / "dump.spool"], capture_output=True,
                          text=True, env={**os.environ, "SPOOL": str(spool), "BLENDER": str(blender)})
    assert done.returncode == 3 and done.stderr == "record.sh: SPOOL=%s is no program: set it to the built one\n" % spool
    assert not (tmp_path / "rendered").exists()


def test_a_failure_of_the_recorder_is_the_failure_of_the_script(tmp_path):
    done = run("nowhere", "-o", tmp_path / "dump.spool")
    assert done.returncode == 2 and "scene 'nowhere' is unknown" in done.stderr
    assert not (tmp_path / "dump.spool").exists()


@pytest.mark.parametrize("arguments, message", [
    ((), "dumps/record.sh NAME"), (("--size", "3"), "first argument"), (("chess",), "give -o FILE.spool"),
    (("chess", "-o"), "-o needs a file")])
def test_wrong_use_says_how(arguments, message):
    done = run(*arguments)
    assert done.returncode == 2 and message in done.stderr


def fake_python(folder, body):
    """A python3 for record.sh whose verify.py does something else; returns the environment."""
    folder.mkdir()
    (folder / "python3").write_text("#!/bin/sh\ncase $1 in *verify.py) %s ;; *) exec /usr/bin/python3 \"$@\" ;; esac\n" % body)
    (folder / "python3").chmod(0o755)
    return {**os.environ, "SPOOL": SPOOL, "PATH": "%s:%s" % (folder, os.environ["PATH"])}


def run_with(environment, *options):
    return subprocess.run([ROOT / "dumps" / "record.sh", *map(str, options)], capture_output=True, text=True, timeout=280, env=environment)


@pytest.fixture(scope="module")
def untested(tmp_path_factory):
    """A recording that is packed, its passes gone, and whose test died: with Python's exit code of an error, and by a signal."""
    if not os.path.exists(SPOOL):
        pytest.skip("NOT TESTED: the program spool is not built")
    folder = tmp_path_factory.mktemp("untested")
    options = ("chess", "--size", "20x12", "--samples", "4", "--seed", "3", "-o", folder / "chess.spool")
    environments = [fake_python(folder / name, body) for name, body in (("raises", "exit 1"), ("killed", "kill -9 $$"))]
    return folder, options, [run_with(environment, *options) for environment in environments]


def kept(folder):
    return hashlib.sha256((folder / "chess.spool.passes" / "whole.spool").read_bytes()).hexdigest()


def test_a_test_that_dies_is_no_failed_claim_and_takes_nothing_with_it(untested):
    folder, _, dones = untested
    for done in dones:
        assert done.returncode == 3 and not (folder / "chess.spool").exists(), done.stderr
        last = done.stderr.splitlines()[-1]
        assert last.startswith("record.sh: ") and "is kept in %s" % (folder / "chess.spool.passes" / "whole.spool") in last
    assert kept(folder)


@pytest.mark.parametrize("more", [("--samples", "x"), ("--dry-run",), ("--smaples", "3"), ("--seed", "4")])
def test_a_command_that_is_refused_or_renders_nothing_keeps_what_is_packed(untested, more):
    folder, options, _ = untested
    before = kept(folder)
    run(*options, *more)
    assert kept(folder) == before


def test_another_command_waits_while_a_recording_is_tested(untested):
    folder, options, _ = untested
    before = kept(folder)
    process = subprocess.Popen([ROOT / "dumps" / "record.sh", *map(str, options)], env=fake_python(folder / "slow", "echo testing; exec sleep 300"),
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True)
    assert "testing\n" in iter(process.stdout.readline, "")
    done = run(*options)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert done.returncode == 2 and "another recorder is writing here" in done.stderr, done.stderr
    assert kept(folder) == before


def test_fewer_samples_than_a_packed_recording_had_are_rendered_and_packed(untested):
    folder, options, _ = untested
    done = run(*options, "--samples", "2")
    assert done.returncode == 0, done.stderr
    told = subprocess.run([SPOOL, "info", folder / "chess.spool", "--json"], capture_output=True, text=True)
    assert json.loads(told.stdout)["samples_per_pixel"] == 2
    assert not (folder / "chess.spool.passes").exists()
