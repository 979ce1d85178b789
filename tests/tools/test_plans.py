"""`spool evaluate PLAN.toml`: dry run, resuming, shards, failures, and what a folder refuses."""
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from conftest import PROGRAM, samples, write_dump
from results_comparison import assert_same_results, cell_lines, changed_cells, rows_of
from tools.study.kept import checked

KILLS = int(os.environ.get("SPOOL_KILLS", "5"))

PLAN = """
title = "small"
recordings = ["scene.spool", "other.spool"]
spp = [2, 4]
replicates = 2
samplers = ["uniform"]
filters = ["box"]
[[sampler]]
name = "multiscale"
alpha = [0.3, 0.5]
[[filter]]
name = "gaussian"
sigma = [1, 2]
"""
CELLS = 2 * 2 * 2 * 3 * 3


@pytest.fixture
def plan(tmp_path, dump):
    write_dump(tmp_path / "other.spool", samples(seed=2)[0])
    path = tmp_path / "plan.toml"
    path.write_text(PLAN)
    return path


def test_sweeps_become_rows_and_both_tables_say_the_same(good, plan, tmp_path):
    good("evaluate", plan, "-o", "out", "--no-pictures")
    rows = rows_of(tmp_path / "out")
    assert len(rows) == CELLS
    assert {r["sampler"] for r in rows} == {"uniform", "multiscale{alpha=0.3}", "multiscale{alpha=0.5}"}
    assert {r["filter"] for r in rows} == {"box", "gaussian{sigma=1}", "gaussian{sigma=2}"}
    for row, line in zip(rows, (tmp_path / "out" / "results.jsonl").read_text().splitlines(), strict=True):
        entry = json.loads(line)
        assert list(entry) == list(row)
        for name, value in entry.items():
            text = row[name]
            assert text == (value or "") if isinstance(value, str) else (
                text == "" if value is None else float(text) == value)


LABELLED = """
recordings = ["scene.spool"]
spp = [2]
replicates = 2
samplers = ["uniform"]
filters = ["box"]
[[sampler]]
name = "multiscale"
alpha = [0.3, 0.5]
label = "swept"
[[filter]]
name = "gaussian"
sigma = 2
label = "ours"
"""


def test_labels_name_methods_in_tables_pictures_and_reports(good, plan, tmp_path):
    plan.write_text(LABELLED)
    table = good("evaluate", plan, "-o", "out", "--json").json["results"]
    rows = rows_of(tmp_path / "out")
    assert {r["sampler"] for r in rows} == {"uniform", "swept{alpha=0.3}", "swept{alpha=0.5}"}
    assert {r["filter"] for r in rows} == {e["filter"] for e in table} == {"box", "ours"}
    assert all("ratio" in e["ranks"]["mse"] for e in table if (e["sampler"], e["filter"]) != ("uniform", "box"))
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert {"scene_uniform_ours_2spp", "scene_swept_alpha_0.3_box_2spp"} <= names
    statistics = json.loads((tmp_path / "out" / "statistics.json").read_text())
    assert "ours" in {e["filter"] for c in statistics["conditions"] for e in c["ranking"]}
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert {"name": "gaussian", "label": "ours"}.items() <= manifest["plan"]["filters"][1].items()
    good("evaluate", tmp_path / "out" / "plan.toml", "-o", "again", "--no-pictures")
    assert_same_results(tmp_path / "out", tmp_path / "again", apart=("dump", "dump_path"))


def test_labels_on_a_command_line(good, run, dump, tmp_path):
    evaluate = ("evaluate", dump, "--spp", 2, "--replicates", 1, "--no-pictures", "-o", "out")
    good(*evaluate, "--samplers", "uniform,ours=multiscale:paper{alpha=0.3}", "--filters", "box,soft=gaussian")
    rows = rows_of(tmp_path / "out")
    assert {(r["sampler"], r["filter"]) for r in rows} == {(s, f) for s in ("uniform", "ours") for f in ("box", "soft")}
    for samplers, reason in (("=multiscale", "label ''"), ("a b=multiscale", "letters"), ("a/b=multiscale", "letters"),
                             ("box=multiscale,uniform=multiscale", "is the name of a sampler"),
                             ("a=uniform,a=multiscale", "sampler a is there twice")):
        run(*evaluate, "--samplers", samplers).failed_with(2, reason)


def test_the_manifest_says_how_it_was_made(good, plan, tmp_path):
    good("evaluate", plan, "-o", "out", "--no-pictures")
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert [d["index_sha256"] for d in manifest["dumps"]] == [index_sha256(tmp_path / name) for name in ("scene.spool", "other.spool")]
    assert manifest["version"].startswith("spool ") and "evaluate" in manifest["command"]
    assert manifest["machine"]["threads"] >= 1
    methods = {m["label"]: m["options"] for m in manifest["plan"]["samplers"]}
    assert methods["multiscale{alpha=0.3}"]["alpha"] == "0.3" and len(methods["multiscale{alpha=0.3}"]) > 10
    good("evaluate", "out/plan.toml", "-o", "again", "--no-pictures")
    assert_same_results(tmp_path / "out", tmp_path / "again", apart=("dump", "dump_path"))


def index_sha256(path):
    """Of the first 64 bytes and of index and footer, whose offset is at the beginning of the footer (formats/spool.md)."""
    data = path.read_bytes()
    return hashlib.sha256(data[:64] + data[int.from_bytes(data[-64:-56], "little"):]).hexdigest()


def test_recordings_are_known_by_their_index(good, run, plan, tmp_path):
    good("evaluate", plan, "-o", "out", "--no-pictures")
    scene = tmp_path / "scene.spool"
    assert good("info", scene, "--json").json["index_sha256"] == index_sha256(scene)
    rest = scene.read_bytes()
    changed = bytearray(rest)
    changed[len(rest) // 2] ^= 1  # a sample: the index says nothing of it, reading the sample does
    scene.write_bytes(changed)
    good("evaluate", plan, "--merge", "-o", "out", "--no-pictures")
    run("evaluate", plan, "-o", "new", "--no-pictures").failed_with(1, "results failed", "checksum")
    scene.write_bytes(rest)
    (tmp_path / "other.spool").unlink()
    write_dump(tmp_path / "other.spool", samples(seed=3)[0])
    for words in (("--merge", "-o", "out"), ("-o", "out"), ("--merge", "-o", "more", "--from", "out")):
        run("evaluate", plan, *words).failed_with(2, "other.spool", "not the recording")


def test_folders_of_older_programs_know_recordings_by_their_whole_file(good, run, plan, tmp_path):
    """Without index_sha256 in dumps.json."""
    good("evaluate", plan, "-o", "out", "--no-pictures")
    good("evaluate", plan, "-o", "new", "--no-pictures")
    known = json.loads((tmp_path / "out" / "dumps.json").read_text())
    older = [{"path": d["path"], "bytes": d["bytes"], "modified": d["modified"],
              "sha256": hashlib.sha256(Path(d["path"]).read_bytes()).hexdigest()} for d in known]
    (tmp_path / "out" / "dumps.json").write_text(json.dumps(older))
    assert all(c["paired"] for c in good("compare", "out", "new", "--all", "--json").json["comparisons"])
    os.utime(tmp_path / "scene.spool")  # read once more, and the same
    good("evaluate", plan, "-o", "out", "--no-pictures")
    assert all(d["index_sha256"] for d in json.loads((tmp_path / "out" / "dumps.json").read_text()))
    (tmp_path / "out" / "dumps.json").write_text(json.dumps(older))
    (tmp_path / "other.spool").unlink()
    write_dump(tmp_path / "other.spool", samples(seed=3)[0])
    run("evaluate", plan, "-o", "out").failed_with(2, "other.spool", "not the recording")


def test_a_dry_run_lists_the_cells_and_writes_nothing(good, plan, tmp_path):
    before = sorted(p.name for p in tmp_path.iterdir())
    out = good("evaluate", plan, "--dry-run").out
    assert sum(" + " in line for line in out.splitlines()) == CELLS
    assert f"{CELLS} cells: 2 recordings x 3 samplers" in out and "about " in out
    assert sorted(p.name for p in tmp_path.iterdir()) == before
    seconds = good("evaluate", plan, "--dry-run", "--json").json
    assert seconds["cells"] == CELLS and 0 < seconds["seconds"] < 600
    good("evaluate", plan, "-o", "out", "--no-pictures")
    done = good("evaluate", plan, "--dry-run", "-o", "out")
    assert f"{CELLS} done, 0 left" in done.out and "nothing is left" in done.out


def test_a_dry_run_names_the_layers_that_no_method_reads(good, tmp_path):
    # Film positions of chess are of a pass, not of a sample: no layer to leave out.
    chess = Path(__file__).parents[2] / "dumps" / "tiny" / "chess.spool"
    plain = ["evaluate", chess, "--spp", "4", "--replicates", "2", "--dry-run", "--samplers", "uniform", "--filters"]
    line = "chess.spool: no method of the plan reads albedo, normal, depth (54 % of the bytes of a sample)"
    out = good(*plain, "box").out
    assert line in out and "2 cells: 1 recording x 1 sampler x 1 budget x 2 replicates x 1 number of threads x 1 filter; 0 done" in out
    told = good(*plain, "box", "--json").json["unused_layers"]
    assert [(one["recording"], one["layers"]) for one in told] == [("chess.spool", ["albedo", "normal", "depth"])]
    assert told[0]["share"] == pytest.approx(14 / 26)
    assert "no method of the plan" not in good(*plain, "cross_bilateral").out


def test_a_misspelt_key_is_named_with_its_line_and_the_nearest(run, plan):
    plan.write_text(PLAN.replace("replicates", "replicats"))
    run("evaluate", plan, "-o", "out").failed_with(2, "plan.toml:5", "did you mean 'replicates'")
    plan.write_text(PLAN.replace("alpha", "alhpa"))
    run("evaluate", plan, "-o", "out").failed_with(2, "did you mean 'alpha'")
    plan.write_text(PLAN)
    run("evaluate", plan, "--spp", 4, "-o", "out").failed_with(2, "--spp", "the plan")
    run("evaluate", plan, plan, "-o", "out").failed_with(2, "one plan")
    run("evaluate", plan).failed_with(2, "-o")
    run("evaluate", plan, "--shard", "4/4", "-o", "out").failed_with(2, "--shard 4/4")


def test_nothing_finished_is_done_again(good, plan, tmp_path):
    good("evaluate", plan, "-o", "out", "--no-pictures")
    cells = cell_lines(tmp_path / "out")
    assert len(cells) == CELLS
    first = (tmp_path / "out" / "results.csv").read_bytes()
    good("evaluate", plan, "-o", "out", "--no-pictures")
    assert cell_lines(tmp_path / "out") == cells
    assert (tmp_path / "out" / "results.csv").read_bytes() == first
    plan.write_text(PLAN.replace("[2, 4]", "[2, 4, 8]"))
    good("evaluate", plan, "-o", "out", "--no-pictures")
    assert set(cells) < set(cell_lines(tmp_path / "out"))
    assert len(rows_of(tmp_path / "out")) == CELLS * 3 // 2
    good("evaluate", plan, "-o", "out", "--no-pictures", "--force")
    assert not set(cells) & set(cell_lines(tmp_path / "out"))  # other times


def test_a_killed_run_goes_on_to_the_same_results(good, plan, tmp_path):
    good("evaluate", plan, "-o", "whole")
    chance = random.Random(7)
    kills = killed_within = 0
    while kills < KILLS or (killed_within == 0 and kills < 20 * KILLS):  # a machine may run on before a kill
        folder = tmp_path / "killed"
        shutil.rmtree(folder, ignore_errors=True)
        pictures = [] if kills == 0 else ["--no-pictures"]
        threads = chance.choice(["1", "2"])
        victim = subprocess.Popen([PROGRAM, "evaluate", plan, "-o", folder, "--threads", threads,
                                   *pictures], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        enough = chance.randrange(CELLS // 2)
        while len(cell_lines(folder)) < enough and victim.poll() is None:
            time.sleep(0.001)
        time.sleep(chance.uniform(0.0, 0.01))
        victim.kill()
        victim.wait()
        kept = cell_lines(folder)
        killed_within += 0 < len(kept) < CELLS
        good("evaluate", plan, "-o", folder, *pictures)
        assert set(kept) < set(cell_lines(folder)) or len(kept) == CELLS, kills
        assert_same_results(tmp_path / "whole", folder, images=not pictures)
        kills += 1
    assert killed_within > 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_keeps_what_is_done_and_says_so(plan, good, tmp_path, number):
    plan.write_text(PLAN.replace("replicates = 2", "replicates = 500"))
    victim = subprocess.Popen([PROGRAM, "evaluate", plan, "-o", tmp_path / "out", "--no-pictures"],
                              stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    deadline = time.monotonic() + 60
    while len(cell_lines(tmp_path / "out")) < 3 and time.monotonic() < deadline:
        time.sleep(0.02)
    victim.send_signal(number)
    message = victim.communicate(timeout=30)[1]
    assert victim.returncode == 128 + number
    kept = cell_lines(tmp_path / "out")
    assert len(kept) >= 3 and len(list(tmp_path.glob("out/cells/*"))) == 1
    assert f"{len(kept)} of {CELLS * 250} results are kept" in message, message
    assert "the same command goes on" in message


def test_shards_in_one_folder_or_in_several_merge_to_the_same_bits(good, run, plan, tmp_path):
    plan.write_text(PLAN.replace("sigma = [1, 2]", ""))
    good("evaluate", plan, "-o", "whole")
    for i in (2, 0, 1):
        good("evaluate", plan, "--shard", f"{i}/3", "-o", "shared", "--no-pictures")
        good("evaluate", plan, "--shard", f"{i}/3", "-o", f"own{i}")
    assert not (tmp_path / "shared" / "results.csv").exists()
    run("evaluate", plan, "--merge", "-o", "merged", "--from", "own0", "--from", "own1").failed_with(
        1, "results are missing")
    for _ in range(2):  # merging again changes nothing
        good("evaluate", plan, "--merge", "-o", "shared", "--no-pictures")
        good("evaluate", plan, "--merge", "-o", "merged", "--from", "own0", "--from", "own1",
             "--from", "own2", "--from", "merged")
        assert_same_results(tmp_path / "whole", tmp_path / "shared")
        assert_same_results(tmp_path / "whole", tmp_path / "merged", images=True)
    assert len(json.loads((tmp_path / "shared" / "manifest.json").read_text())["shards"]) == 3
    good("evaluate", plan, "--shard", "1/3", "-o", "shared", "--no-pictures")  # idempotent
    good("evaluate", plan, "--merge", "-o", "shared", "--no-pictures")
    assert_same_results(tmp_path / "whole", tmp_path / "shared")


def test_one_failed_cell_is_recorded_and_tried_again(good, run, plan, tmp_path):
    counts = tmp_path / "counts.exr"
    plan.write_text(PLAN.replace('samplers = ["uniform"]', f'samplers = ["uniform", "counts:{counts}"]'))
    good("replay", "scene.spool", "--sampler", "uniform", "--spp", 16, "-o", counts)  # beyond every budget
    run("evaluate", plan, "-o", "out", "--no-pictures").failed_with(1, "24 of 96 results failed")
    rows = rows_of(tmp_path / "out")
    failed = [r for r in rows if r["sampler"].startswith("counts:")]
    assert len(rows) == 96 and len(failed) == 24
    assert all(r["error"] and r["mse"] == "" for r in failed)
    assert all(r["mse"] and not r["error"] for r in rows if r not in failed)
    good("replay", "scene.spool", "--sampler", "uniform", "--spp", 2, "-o", counts, "--force")
    run("evaluate", plan, "-o", "out", "--no-pictures")
    assert any(r["mse"] for r in rows_of(tmp_path / "out") if r["sampler"].startswith("counts:"))


def test_a_damaged_cell_counts_as_missing(good, plan, tmp_path):
    good("evaluate", plan, "-o", "whole", "--no-pictures")
    good("evaluate", plan, "-o", "out", "--no-pictures")
    file, = (tmp_path / "out" / "cells").iterdir()
    lines = file.read_text().splitlines(keepends=True)
    one, two, three, cut = lines[:4]
    damaged = [one[:100] + "\n", two.replace('"relmse":"', '"relmse":"1'), three.replace('"cell":"', '"cell":"f'), "\0" * 300 + "\n"]
    file.write_text("".join(damaged + lines[4:]) + cut[:50])
    (tmp_path / "out" / "cells" / "0123.json.77.partial").write_text("rest of a killed run")
    (tmp_path / "out" / "cells" / "~endless.jsonl").write_text("x" * (40 << 20))
    told = good("evaluate", plan, "-o", "out", "--no-pictures").err
    assert f"6 damaged results count as missing; the first: out/cells/{file.name}, line 1" in told
    assert_same_results(tmp_path / "whole", tmp_path / "out")
    assert len(cell_lines(tmp_path / "out")) == CELLS + 4  # damaged ones and all


def test_cells_of_an_earlier_version_go_on(good, run, plan, tmp_path):
    """One file of each: cells/ID.json. What failed in one is tried again, what is none counts as missing."""
    good("evaluate", plan, "-o", "whole", "--no-pictures")
    shutil.copytree(tmp_path / "whole", tmp_path / "out")
    file, = (tmp_path / "out" / "cells").iterdir()
    for number, line in enumerate(file.read_text().splitlines()):
        cell = json.loads(line)
        old = {k: v for k, v in cell.items() if k not in ("crc32", "cell", "failed")}
        if number == 0:
            old["fields"] = {"error": "no such luck"}
        (file.parent / (cell["cell"] + ".json")).write_text(json.dumps(old) if number != 1 else "{")
    file.unlink()
    run("evaluate", plan, "-o", "merged", "--merge", "--from", "out", "--no-pictures").failed_with(1, "results are missing")
    good("evaluate", plan, "-o", "out", "--no-pictures")
    assert len(cell_lines(tmp_path / "out")) == 2
    assert_same_results(tmp_path / "whole", tmp_path / "out")
    good("evaluate", plan, "-o", "merged", "--merge", "--from", "out", "--no-pictures")
    assert_same_results(tmp_path / "whole", tmp_path / "merged")


def test_a_cell_is_understood_or_missing(good, run, plan, tmp_path):
    """Numbers as numbers, keys of other programs and in any order are no damage; halves that are none are not measured."""
    good("evaluate", plan, "-o", "whole", "--no-pictures")
    shutil.copytree(tmp_path / "whole", tmp_path / "out")
    def another(cell):
        fields = {"other": [1, {"mse": "7"}], "nested": {"mse": "9"}, **dict(reversed(cell["fields"].items())), "samples_spent": int(cell["fields"]["samples_spent"])}
        return {"more": [[], {"fields": {"mse": "3"}}], **{k: cell[k] for k in reversed(cell) if k != "fields"}, "fields": fields}
    changed_cells(tmp_path / "out", another)
    good("evaluate", plan, "--merge", "-o", "out", "--no-pictures")
    assert_same_results(tmp_path / "whole", tmp_path / "out")
    assert (tmp_path / "out" / "statistics.json").read_bytes() == (tmp_path / "whole" / "statistics.json").read_bytes()
    halves = next(c["halves"] for c in map(json.loads, cell_lines(tmp_path / "out")) if "halves" in c)
    for wrong in ({"columns": 0}, {"columns": "4"}, {"cells": "1 2 x"}, {"cells": "nan"}, {"cells": 3}, {"columns": 10**9}):
        damaged = {metric: {**entry, **wrong} for metric, entry in halves.items()}
        changed_cells(tmp_path / "out", lambda cell: {**cell, "halves": damaged} if "halves" in cell else cell)
        good("evaluate", plan, "--merge", "-o", "out", "--no-pictures")
        assert_same_results(tmp_path / "whole", tmp_path / "out")
    first, *others = cell_lines(tmp_path / "out")
    start = '"cell":"%s","failed":0,' % json.loads(first)["cell"]
    for text in ("", "}", "3", '"fields": 3}', '"fields": {"mse": "1"}} x', '"fields": {}}\0', '"x":' + "[" * 100000):
        (tmp_path / "out" / "cells" / "changed.jsonl").write_text(checked(start + text) + "".join(others))
        run("evaluate", plan, "--merge", "-o", "out", "--no-pictures").failed_with(1, "1 of 72 results are missing")


def test_a_folder_refuses_what_would_be_mixed_up(good, run, plan, tmp_path):
    good("evaluate", plan, "-o", "out", "--no-pictures")
    plan.write_text(PLAN.replace("[2, 4]", "[2]"))
    run("evaluate", plan, "-o", "out").failed_with(2, "36 results that this plan does not have")
    plan.write_text(PLAN)
    (tmp_path / "other.spool").unlink()
    write_dump(tmp_path / "other.spool", samples(seed=3)[0])
    run("evaluate", plan, "-o", "out").failed_with(2, "other.spool", "not the recording", "--force")
    run("evaluate", plan, "--merge", "-o", "new", "--from", "out").failed_with(2, "other.spool")
    assert not (tmp_path / "new").exists()
    good("evaluate", plan, "-o", "out", "--no-pictures", "--force")
    (tmp_path / "strange").mkdir()
    (tmp_path / "strange" / "thesis.tex").write_text("mine")
    run("evaluate", plan, "-o", "strange").failed_with(2, "holds no results", "or give --force")
    shard = run("evaluate", plan, "-o", "strange", "--shard", "0/2")
    shard.failed_with(2, "choose another name")
    assert "--force" not in shard.err
    assert (tmp_path / "strange" / "thesis.tex").read_text() == "mine"


def test_a_merge_that_cannot_be_leaves_no_folder_and_no_results_of_other_plans(good, run, plan, tmp_path):
    run("evaluate", plan, "--merge", "-o", "new").failed_with(1, "new: no finished results")
    (tmp_path / "empty" / "cells").mkdir(parents=True)
    run("evaluate", plan, "--merge", "-o", "new", "--from", "empty").failed_with(1, "new: no finished results")
    good("evaluate", plan, "-o", "out", "--no-pictures")
    plan.write_text(PLAN.replace("[2, 4]", "[2]"))
    run("evaluate", plan, "--merge", "-o", "new", "--from", "out").failed_with(2, "out: holds 36 results that this plan does not have")
    assert not (tmp_path / "new").exists()
    good("evaluate", plan, "--merge", "-o", "new", "--from", "out", "--no-pictures", "--force")
    assert len(rows_of(tmp_path / "new")) == CELLS // 2
    run("evaluate", plan, "--merge", "-o", "new/in/it", "--from", "new").failed_with(2, "new/in/it: lies in new")
    assert not (tmp_path / "new" / "in").exists()
    good("evaluate", plan, "-o", "new/part", "--no-pictures")
    good("evaluate", plan, "--merge", "-o", "new", "--from", "new/part", "--no-pictures", "--force")


def test_a_merge_that_stops_among_the_images_takes_no_cells(good, run, plan, tmp_path):
    good("evaluate", plan, "-o", "out")
    os.mkfifo(tmp_path / "out" / "a pipe")
    run("evaluate", plan, "--merge", "-o", "new", "--from", "out").failed_with(3, "out/a pipe")
    assert not cell_lines(tmp_path / "new")
    (tmp_path / "out" / "a pipe").unlink()
    good("evaluate", plan, "--merge", "-o", "new", "--from", "out")
    assert_same_results(tmp_path / "out", tmp_path / "new", images=True)


def test_a_limit_below_the_sweep_is_refused(run, dump, tmp_path):
    (tmp_path / "sweep.toml").write_text(f'recordings = ["{dump}"]\nspp = [4]\nthreads = [1, 2]\n[[sampler]]\nname = "uniform"\n'
                                         '[[filter]]\nname = "box"\n')
    for what in (("sweep.toml",), (dump, "--spp", 4, "--sweep-threads", "2,1")):
        run("evaluate", *what, "-o", "out", "--threads", 1).failed_with(2, "--threads 1: the sweep goes up to 2: leave --threads out")


def test_what_would_decide_is_named_once_over_threads(good, dump):
    text = good("evaluate", dump, "--spp", 4, "--samplers", "uniform,multiscale", "--replicates", 2, "--sweep-threads", "1,2", "-o", "out").out
    named = text.split("Would decide what is undecided, about: ")[1].split(".\n")[0].split("; ")
    assert len(named) == 1 and text.count("undecided\n") == 2, text


def test_threads_may_be_swept_over_and_repeats_give_spreads(good, dump, tmp_path):
    good("evaluate", dump, "--spp", 4, "--filters", "gaussian", "--replicates", 2, "--repeats", 3,
         "--sweep-threads", "1,2", "-o", "out")
    table = good("evaluate", dump, "--spp", "2,4", "--filters", "box,gaussian", "--replicates", 2, "--sweep-threads", "1,2", "--wide", "-o",
                 "both").out.split("In the processor time")[1].split("\n\n")[0].splitlines()
    assert table[1].endswith("threads") and [line.split()[-1] for line in table[2:]] == ["1", "1", "2", "2"]
    rows = rows_of(tmp_path / "out")
    assert [(r["replicate"], r["threads"], r["threads_used"]) for r in rows] == [
        ("0", "1", "1"), ("0", "2", "2"), ("1", "1", "1"), ("1", "2", "2")]
    assert rows[0]["mse"] == rows[1]["mse"] != rows[2]["mse"]
    assert all(float(r["seconds_filtering_spread"]) > 0 for r in rows)
    assert float(rows[0]["seconds_writing"]) > 0 and rows[2]["seconds_writing"] == "0"
    assert all(1 < float(r["peak_memory_mb"]) < 4000 for r in rows)
