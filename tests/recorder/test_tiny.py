"""The committed recordings: whole, what the catalogue says, and their samples are what their headers claim."""
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib

import numpy as np
import pytest
from conftest import ROOT

import spool
from dumps import catalogue, pool_pins

DUMPS = ROOT / "dumps"
SPOOL = os.environ.get("SPOOL", str(ROOT / "build" / "release" / "spool"))
ENTRIES = {entry["name"]: entry for entry in catalogue.catalogue()["recording"]}


@pytest.fixture(params=ENTRIES)
def entry(request):
    return ENTRIES[request.param]


def test_the_catalogue_lists_every_recording_and_they_stay_small():
    files, shown = sorted((DUMPS / "tiny").glob("*.spool")), sorted(DUMPS.glob("*.spool"))
    assert sorted(DUMPS / e["file"] for e in ENTRIES.values()) == sorted(shown + files)
    assert sum(f.stat().st_size for f in shown) <= 12e6
    assert max(f.stat().st_size for f in files) <= 4e6
    assert sum(f.stat().st_size for f in files) <= 24e6


def test_every_scene_of_the_tree_is_recorded_and_one_with_both_renderers():
    scenes = {(e["arguments"][0], e["renderer"]) for e in ENTRIES.values() if "source" not in e}
    assert {scene for scene, _ in scenes} == {p.stem for p in (DUMPS / "scenes").glob("*.py")}
    assert {("caustic", "Cycles"), ("caustic", "Mitsuba")} <= scenes


def test_the_file_is_what_the_catalogue_says(entry):
    found, picture = catalogue.measure(entry)
    assert {key: entry[key] for key in catalogue.MEASURED} == found
    assert (DUMPS / entry["preview"]).read_bytes() == catalogue.png_bytes(picture)
    assert picture.std() > 10 and picture.max() == 255
    with spool.open(DUMPS / entry["file"]) as dump:
        meta = dump.meta
        assert meta["reference"]["samples"] == entry["reference"] >= (3000 if "source" in entry else 4096)
        assert entry["arguments"][0].endswith(meta["scene"]["name"])
        renderer = meta["renderer"] if isinstance(meta["renderer"], str) else meta["renderer"]["name"]
        assert renderer == entry["renderer"]
        if renderer == "Cycles":
            needs = {need.replace("_", " ") for need, present in meta["needs"].items() if present}
            assert needs == set(entry["needs"])


def test_the_scene_has_not_changed_since_it_was_recorded(entry):
    if "source" in entry:               # by others, and not in the tree: the list of pools has its hash
        with open(DUMPS / "POOLS.toml", "rb") as stream:
            pool = next(p for p in tomllib.load(stream)["pool"] if p["name"] == entry["pool"])
        assert pool["source"] == entry["source"]
        with spool.open(DUMPS / entry["file"]) as dump:
            assert dump.meta["scene"]["sha256"] == pool["scene_sha256"]
        return
    if entry["renderer"] == "Mitsuba":
        from dumps.mitsuba.scene import model
        sources = model.scene_sources(entry["arguments"][0])
    else:
        sources = [DUMPS / "scenes" / (entry["arguments"][0] + ".py")] + sorted((DUMPS / "scenes" / "model").glob("*.py"))
    digest = hashlib.sha256(b"".join(open(source, "rb").read() for source in sources)).hexdigest()
    with spool.open(DUMPS / entry["file"]) as dump:
        assert dump.meta["scene"]["sha256"] == digest


def test_the_reference_is_good_enough_to_judge_eight_samples(entry):
    """Its own standard error is at most a fiftieth of the error of 8 samples, over the whole picture."""
    with spool.open(DUMPS / entry["file"]) as dump:
        eighth = dump.read("radiance").astype(float).var(axis=2, ddof=1).sum() / 8
        share = np.sqrt(dump.pixel("reference_variance").astype(float).sum() / eighth)
        assert share < (0.06 if "source" in entry else 0.02)      # large and smooth: its few samples already are its picture
        noise = dump.pixel("reference_variance") / (dump.pixel("reference").astype(float) ** 2 + 0.01)
        assert "source" not in entry or noise.mean() < 1e-4      # of relMSE's denominator, a thirtieth of what --reference auto asks for


def test_samples_of_the_dump_are_what_its_header_claims(entry):
    done = subprocess.run([sys.executable, DUMPS / "verify" / "verify.py", DUMPS / entry["file"], "--json"],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout)
    with spool.open(DUMPS / entry["file"]) as dump:
        kept = dump.meta["verification"]
    later = ("images differ",)  # is younger than the recordings of the tree
    assert all(c["holds"] for c in found["findings"] if c["name"] in later)
    assert [(c["name"], c["holds"]) for c in kept["findings"] if c["name"] not in later] == [
        (c["name"], c["holds"]) for c in found["findings"] if c["name"] not in later]
    assert kept["holds"] and "reference error" in done.stdout


def test_the_program_shows_the_verification(entry):
    if not os.path.exists(SPOOL):
        pytest.skip("NOT TESTED: the program spool is not built")
    told = subprocess.run([SPOOL, "info", DUMPS / entry["file"], "--all"], capture_output=True, text=True)
    assert told.returncode == 0 and "yes: " in told.stdout and "correlation at lag 1" in told.stdout


def test_the_catalogue_prints_commands():
    def told(*options):
        return subprocess.run([sys.executable, DUMPS / "catalogue.py", *options], capture_output=True, text=True)

    assert told("--command", "mist").stdout == (
        "dumps/record.sh mist --mode iid --seed 1 --size 64 --samples 64 --reference 24576 --compress "
        "-o dumps/tiny/mist.spool\n")
    full = told("--full", "caustic_mitsuba", "--size", "99", "-o", "x.spool").stdout.splitlines()
    assert shlex.join(full) == ("dumps/mitsuba/record.py caustic --seed 1 --channels radiance --size 99 -o x.spool "
                                "--samples 256 --reference 4096")
    assert told("--full", "nowhere").returncode == 2 and "use chess" in told("--full", "nowhere").stderr
    assert len(told().stdout.splitlines()) == 2 * len(ENTRIES)


@pytest.mark.parametrize("program", ["catalogue.py", "pools.py"])
def test_a_reader_that_goes_away_ends_a_list_quietly(program):
    reading, writing = os.pipe()
    os.close(reading)
    ended = subprocess.run([sys.executable, DUMPS / program], stdout=writing, stderr=subprocess.PIPE, text=True)
    os.close(writing)
    assert (ended.returncode, ended.stderr) == (141, "")


def test_the_page_shows_what_is_pinned():
    printed = subprocess.run([sys.executable, ROOT / "dumps/pools.py", "--table"], capture_output=True, text=True, check=True).stdout
    assert len(printed.splitlines()) > 12 and printed in (ROOT / "docs/recording.md").read_text()


def test_a_pin_names_renderer_and_version(entry):
    assert re.fullmatch(rf"{entry['renderer']} \d+\.\d+.*", pool_pins.measure(DUMPS / entry["file"])["versions"])
