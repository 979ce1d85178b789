"""Pools of full size, made small: recorded one after the other, gone on with after kills, compared with what is pinned."""
import fcntl
import hashlib
import os
import random
import signal
import subprocess
import sys
import time
import tomllib

import numpy as np
import pytest

import spool
from conftest import RECORD, ROOT, check_ok, record
from dumps.verify.content_hash import content_hash

POOLS = os.path.join(ROOT, "dumps", "pools.py")
SMALL = """
[[pool]]
name = "one"
renderer = "Mitsuba"
scene = "cornell-box"
arguments = ["--seed", "1", "--chunk-lanes", "4096"]
size = [16, 12]
samples = 24
reference = 256
cost = 1.0

# a comment stays where it is
[[pool]]
name = "two"
renderer = "Mitsuba"
scene = "{scenes}/theirs/lens.xml"
arguments = ["--channels", "radiance"]
size = [12, 12]
samples = 16
reference = 64
cost = 1.0
source = { repository = "https://example.org/someone/theirs", commit = "abc", licence = "CC0" }
"""
SCENE = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><transform name="to_world">
<lookat origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform></sensor><shape type="sphere"/><emitter type="constant"/></scene>"""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "pools.toml").write_text(SMALL)
    return tmp_path


def pools(place, *arguments, **more):
    environment = {**os.environ, "SPOOL_RECORDINGS": str(place / "recordings"), "SPOOL_SCENES": str(place / "scenes"),
                   "SPOOL_MITSUBA_PYTHON": sys.executable}
    return subprocess.run([sys.executable, POOLS, "--pools", str(place / "pools.toml"), *arguments], capture_output=True, text=True,
                          env=environment, **more)


def test_the_listing_says_what_the_table_says(place):
    pinned = 'pinned = { samples_sha256 = "ab", bytes = 1000, cpu_seconds = 474, versions = "x", processor = "y", claims = "84 hold" }'
    text = SMALL.replace('name = "one"', f'name = "{"long_" * 4}one"\nrecordings = 4\n{pinned}')
    (place / "pools.toml").write_text(text)
    listed, table = pools(place).stdout, pools(place, "--table").stdout
    assert "4 of 6 samples" in listed and "| 4 of 6 |" in table and "7 min 54 s" in listed and "| 7:54 |" in table
    assert len({line.index(" samples, ") for line in listed.splitlines() if " samples, " in line}) == 1


def give_scene(place):
    (place / "scenes" / "theirs").mkdir(parents=True)
    (place / "scenes" / "theirs" / "lens.xml").write_text(SCENE)


def test_all_are_recorded_once_and_pinned(place):
    give_scene(place)
    assert "cornell-box" not in pools(place).stdout and "to do" in pools(place).stdout
    result = pools(place, "--all")
    assert result.returncode == 0, result.stdout + result.stderr
    assert "one (1 of 2), about" in result.stdout and "two: " in result.stdout
    with spool.open(place / "recordings" / "two.spool") as dump:
        assert dump.meta["scene"]["name"] == "theirs/lens.xml" and dump.meta["verification"]["holds"] is True
    first = content_hash(str(place / "recordings" / "one.spool"))
    again = pools(place, "--all")
    assert again.returncode == 0 and again.stdout == "one: here already\ntwo: here already\n"
    check_ok(pools(place, "--pin", "one", "two"))
    text = (place / "pools.toml").read_text()
    pinned = {pool["name"]: pool["pinned"] for pool in tomllib.loads(text)["pool"]}
    assert pinned["one"]["samples_sha256"] == first and "Mitsuba" in pinned["two"]["versions"]
    with spool.open(place / "recordings" / "one.spool") as dump:
        assert pinned["one"]["claims"] == "%d hold" % len(dump.meta["verification"]["findings"])
    assert "\n\n# a comment stays where it is\n[[pool]]" in text
    check_ok(pools(place, "--pin", "one"))
    assert text.count("pinned = ") == (place / "pools.toml").read_text().count("pinned = ") == 2

    os.remove(place / "recordings" / "one.spool")          # the same bits again
    check_ok(pools(place, "--record", "one"))
    os.remove(place / "recordings" / "one.spool")
    (place / "pools.toml").write_text(text.replace(first, "0" * 64))
    told = pools(place, "--record", "one")
    assert told.returncode == 1 and "other samples than the pinned ones" in told.stderr
    os.remove(place / "recordings" / "one.spool")
    (place / "pools.toml").write_text(text.replace(first, "0" * 64).replace("llvm_ad_rgb", "cuda_ad_rgb").replace(
        "scalar_rgb", "cuda_ad_rgb"))
    check_ok(pools(place, "--record", "one"))              # another variant may round otherwise


def test_a_scene_that_is_not_there_is_said_with_what_brings_it_and_the_others_are_recorded(place):
    result = pools(place, "--all")
    assert result.returncode == 1 and (place / "recordings" / "one.spool").exists()
    assert "git clone https://example.org/someone/theirs" in result.stderr and "checkout abc" in result.stderr
    assert result.stderr.endswith("not recorded, or not what POOLS.toml says: two\n")


def test_a_changed_scene_is_told(place):
    give_scene(place)
    check_ok(pools(place, "--record", "two"))
    check_ok(pools(place, "--pin", "two"))
    os.remove(place / "recordings" / "two.spool")
    (place / "scenes" / "theirs" / "lens.xml").write_text(SCENE.replace("0,0,-4", "0,0,-5"))
    result = pools(place, "--record", "two")
    assert result.returncode == 1 and "another scene than the expected one" in result.stdout


def test_wrong_names_and_two_runs_at_once_are_refused(place):
    assert pools(place, "--record", "three").returncode == 2
    (place / "recordings").mkdir()
    with open(place / "recordings" / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        result = pools(place, "--record", "one")
    assert result.returncode == 2 and "another run records here" in result.stderr


@pytest.mark.parametrize("arguments, words", [(("--nope",), "unrecognized arguments: --nope"), (("--record",), "argument --record"),
                                              (("--record", "three"), "'three' is not in"), (("--pin", "one"), "no such recording: --record one")])
def test_wrong_use_is_one_line(place, arguments, words):
    told = pools(place, *arguments)
    assert told.returncode == 2 and words in told.stderr and told.stderr.startswith("pools: ") and told.stderr.count("\n") == 1, told.stderr
    assert "Exit codes: 0 done, 1 a recording failed" in pools(place, "--help").stdout


def progress(folder):
    """Chunks of the pool and of the reference that are safe."""
    try:
        chunks = sum(name.startswith("chunk_") and name.endswith(".npz") for name in os.listdir(folder))
        if not os.path.exists(os.path.join(folder, "reference.npz")):
            return chunks
        with np.load(os.path.join(folder, "reference.npz")) as state:
            return chunks + int(state["chunks"])
    except OSError:
        return 0


def test_a_recording_killed_at_five_moments_gives_the_same_bits(tmp_path):
    """32 chunks of the pool and 128 of the reference; the moments are drawn anew each time from a fixed seed."""
    options = ["cornell-box", "--size", 32, "--samples", 64, "--reference", 256, "--chunk-lanes", 1 << 11, "--channels", "all"]
    whole, cut = tmp_path / "whole.spool", tmp_path / "cut.spool"
    check_ok(record(*options, "-o", whole))
    rng, kills = random.Random(7), 0
    for moment in sorted(rng.sample(range(1, 150), 5)):
        process = subprocess.Popen([sys.executable, RECORD, *map(str, options), "-o", str(cut)], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        while process.poll() is None and progress(str(cut) + ".recording") < moment:
            time.sleep(0.01)
        time.sleep(rng.random() * 0.05)
        process.send_signal(signal.SIGKILL)
        kills += process.wait() == -signal.SIGKILL
    assert kills == 5 and not cut.exists()
    check_ok(record(*options, "-o", cut))
    assert content_hash(str(cut)) == content_hash(str(whole))
    with spool.open(whole) as one, spool.open(cut) as two:
        assert one.meta["random_numbers"] == two.meta["random_numbers"]


def test_the_list_has_what_experiments_need():
    with open(os.path.join(ROOT, "dumps", "POOLS.toml"), "rb") as stream:
        found = tomllib.load(stream)["pool"]
    names = [pool["name"] for pool in found]
    assert len(set(names)) == len(names)
    scenes = {name[:-3] for name in os.listdir(os.path.join(ROOT, "dumps", "scenes")) if name.endswith(".py")}
    full = {pool["scene"] for pool in found if pool["size"] == [256, 256] and (pool["samples"], pool["reference"]) == (256, 4096)}
    assert scenes <= full
    assert sum(pool["size"] == [512, 512] for pool in found) >= 2
    assert any(pool["samples"] // pool.get("recordings", 1) == 1024 and pool["size"] == [128, 128] for pool in found)
    assert any("sequence" in pool["arguments"] for pool in found)
    assert sum("source" in pool for pool in found) >= 3
    for pool in found:
        for key in ("repository", "commit", "licence"):
            assert "source" not in pool or pool["source"][key]


def test_time_left_follows_the_pace(monkeypatch):
    from dumps import pool_run
    now = [100.0]
    monkeypatch.setattr(pool_run.time, "monotonic", lambda: now[0])
    pace = pool_run.Pace([10.0, 30.0])
    assert pace.left(0, 0) == pytest.approx(40 / os.cpu_count())
    now[0] += 20.0
    assert pace.left(0, 0.5) == pytest.approx(35 * 4)          # 20 seconds for 5
    assert pace.left(1, 0.5) == pytest.approx(15 * 20 / 25)
    pool = {"samples": 256, "reference": 4096}
    assert pool_run.share_done(pool, "pool", 1, 2) == pytest.approx(128 / 4352)
    assert pool_run.share_done(pool, "reference", 1, 2) == pytest.approx((256 + 2048) / 4352)


def test_a_python_without_numpy_is_refused_before_anything_is_rendered(place):
    finished = subprocess.run([sys.executable, "-S", "-E", POOLS, "--pools", str(place / "pools.toml"), "--record", "one"],
                              capture_output=True, text=True, env={**os.environ, "SPOOL_RECORDINGS": str(place / "recordings")})
    assert finished.returncode == 3, finished.stderr
    assert "numpy" in finished.stderr and "apt-get install" in finished.stderr and "Traceback" not in finished.stderr
    assert not (place / "recordings").exists()


def test_a_group_is_recorded_and_pinned_as_one(place):
    text = SMALL.split("# a comment")[0].replace("samples = 24\n", "samples = 24\nrecordings = 2\n")
    (place / "pools.toml").write_text(text)
    result = pools(place, "--all")
    assert result.returncode == 0, result.stdout + result.stderr
    assert "| 2 of 12 | 256 |" in pools(place, "--table").stdout
    check_ok(pools(place, "--pin", "one"))
    files = [place / "recordings" / ("one_%d.spool" % number) for number in (1, 2)]
    pinned = tomllib.loads((place / "pools.toml").read_text())["pool"][0]["pinned"]
    assert pinned["samples_sha256"] == hashlib.sha256("".join(map(content_hash, map(str, files))).encode()).hexdigest()
    assert pinned["bytes"] == sum(path.stat().st_size for path in files)
    assert pools(place, "--all").stdout == "one: here already\n"
    files[1].unlink()
    assert "one_2.spool: no such recording" in pools(place, "--pin", "one").stderr
