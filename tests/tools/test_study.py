"""The study: pages say what statistics.json says, results are kept so that the program can judge them again."""
import csv
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import LONGEST_RUN, PROGRAM, WITH_OIDN
from plan_methods import methods_of
from results_comparison import cell_lines
from tools.study import full_size, kept, pages, plans, tables

ROOT = Path(__file__).resolve().parents[2]

RESULTS = ROOT / "docs/results"
FULL = sorted((RESULTS / "experiments_full").glob("*.tar.xz"))
EVERY = sorted(RESULTS.glob("*/*.tar.xz"))
MOST_BYTES = 4_000_000


def named(paths):
    return [f"{p.parent.name}-{p.name.split('.')[0]}" for p in paths]


def evaluate(*arguments):
    finished = subprocess.run([PROGRAM, "evaluate", *map(str, arguments), "-q"], text=True, capture_output=True, timeout=LONGEST_RUN)
    assert finished.returncode == 0, finished.stderr


def comparisons(claims):
    """{question and place: (verdict, ratio as printed)}"""
    def than(claim):
        return claim["than"] + (f", threads {claim['threads'][1]}" if "threads" in claim else "")
    return {(c["better"], than(c), c["metric"], c["samples"], tables.number(c["below"]), tables.recording(p["dump"]), tables.number(p["spp"]),
             str(p["threads"])): (p["verdict"], [tables.number(kept.in_digits(v, kept.DIGITS)) for v in p["ratio"]]) for c in claims for p in c["places"]}


def printed(path):
    with open(path, encoding="utf-8", newline="") as stream:
        return {tuple(row[k] for k in ("better", "than", "metric", "samples", "below", "recording", "spp", "threads")):
                (row["verdict"], [row[k] for k in ("ratio", "low", "high") if row[k]]) for row in csv.DictReader(stream)}


def differences(claims, path):
    said, found = printed(path), comparisons(claims)
    return len(found), [key for key in found.keys() | said.keys() if found.get(key) != said.get(key)]


def test_a_group_is_of_recordings_with_a_number_and_no_other_of_that_name():
    assert [plans.group_of(name) for name in ("occluded_1", "occluded_4", "occluded_5", "occluded_256", "occluded", "chess_1")] == [
        "occluded", "occluded", None, None, None, None]


@pytest.mark.parametrize("archive", FULL, ids=named(FULL))
def test_what_is_kept_of_full_size_is_judged_by_the_program_as_the_page_says(archive, tmp_path):
    folder = kept.written(kept.unpack(archive), tmp_path)
    finished = subprocess.run([PROGRAM, "evaluate", "--statistics-only", folder, "-q"], text=True, capture_output=True,
                              timeout=LONGEST_RUN, env=WITH_OIDN)
    assert finished.returncode == 0, finished.stderr
    statistics = json.loads((folder / "statistics.json").read_text())
    assert kept.trimmed(statistics) == json.loads(kept.unpack(archive)["statistics.json"])
    if statistics["claims"]:
        count, wrong = differences(statistics["claims"], archive.parent / f"{archive.name.split('.')[0]}_claims.csv")
        assert count > 0 and wrong == []


@pytest.mark.parametrize("archive", EVERY, ids=named(EVERY))
def test_every_place_of_a_claim_is_printed_with_the_verdict_of_statistics_json(archive):
    claims = json.loads(kept.unpack(archive)["statistics.json"])["claims"]
    if claims:
        count, wrong = differences(claims, archive.parent / f"{archive.name.split('.')[0]}_claims.csv")
        assert count > 0 and wrong == []


@pytest.mark.parametrize("name", ["experiments", "experiments_full"])
def test_page_and_statistics_json_differ_in_no_comparison(name):
    """Of the tables as they stand on the site: every claim's verdict, and its places that hold, are reversed, are undecided."""
    store, compared, wrong = pages.Kept(RESULTS / name), 0, []
    page = "\n\n".join(pages.chapter_claims(store, name == "experiments_full"))
    for section in re.split(r"^### ", page, flags=re.M)[1:]:
        chapter = next(c for c in pages.CHAPTERS if section.startswith(c["id"] + ":"))
        rows = [[cell.strip().replace("\\|", "|") for cell in line.strip("|").split(" | ")] for line in section.splitlines() if line.startswith("| ")]
        columns = rows[0][1:]
        for plan in (*chapter["plans"], *chapter.get("more", ())):
            for claim in store.claims(plan):
                words = [p["verdict"] for p in claim["places"]]
                expected = f"{claim['verdict']} {words.count('holds')}/{words.count('reversed')}/{words.count('undecided')}"
                expected += f" -{words.count('not compared')}" * ("not compared" in words)
                place = [i for i, c in enumerate(columns) if c.endswith(claim["samples"] + " samples")
                         and (len([p for p in chapter["plans"] if store.claims(p)]) == 1 or c.startswith(plan.split("_")[0].upper() + ","))]
                cells = [row[1 + place[0]] for row in rows if row[0].removesuffix(" [R]") == claim["text"]]
                compared += 1
                if expected not in cells and claim["samples"] == "own":
                    wrong.append((plan, claim["text"], cells, expected))
                if claim["samples"] == "fresh" and expected not in [row[1 + place[0]] for row in rows]:
                    wrong.append((plan, claim["text"], expected))
    assert compared > 60 and wrong == []


def stores():
    return pages.Kept(RESULTS / "experiments"), pages.Kept(RESULTS / "experiments_full")


@pytest.mark.parametrize("name", ["experiments", "findings", "filters"])
def test_a_page_is_what_its_template_gives_today(name):
    assert pages.page(f"{name}.in", *stores()) == (ROOT / f"docs/{name}.md").read_text(encoding="utf-8"), "tools/dev.sh experiments --full --write-only"


def test_every_sentence_of_the_findings_names_a_claim():
    text = (pages.HERE / "templates/findings.in").read_text(encoding="utf-8")
    sentences = re.findall(r"^\d+\. \*\*.+?(?=^\d+\. |^\[R\])", text, re.M | re.S)
    assert len(sentences) == 10 and all(pages.CLAIM.search(sentence) for sentence in sentences)


def test_the_verdict_of_the_readme_is_that_of_its_claims():
    claims = list(pages.CLAIM.finditer((ROOT / "README.md").read_text(encoding="utf-8")))
    assert len(claims) == 10 and all(pages.said(claim, *stores()) for claim in claims)


def test_a_sentence_does_not_outlive_its_verdict(tmp_path, monkeypatch):
    small, full = stores()
    claim = full.claims("e3_samplers_over_budget")[0]
    (tmp_path / "templates").mkdir()
    monkeypatch.setattr(pages, "HERE", tmp_path)
    question = "; ".join(["e3_samplers_over_budget", claim["better"], claim["than"], claim["metric"], claim["samples"]])
    (tmp_path / "templates/p.in").write_text("Lower {{" + question + "; holds}}.")
    verdicts = [p["verdict"] for p in claim["places"] if p["verdict"] != "not compared"]
    assert f"{verdicts.count('holds')} of {len(verdicts)} hold" in pages.page("p.in", small, full)
    claim["verdict"] = "mixed"
    with pytest.raises(pages.Changed, match="now 'mixed'"):
        pages.page("p.in", small, full)
    (tmp_path / "templates/p.in").write_text("Lower {{" + question.replace("uniform", "box") + "; holds}}.")
    with pytest.raises(pages.Changed, match="no such claim"):
        pages.page("p.in", small, full)
    several = "{{u3_unseen_network; cross_halves + ensemble:oidn+twin_guides{energy=box}; uniform + oidn{energy=box}; relmse%s; own; %s}}"
    (tmp_path / "templates/p.in").write_text(several % ("", "holds"))
    with pytest.raises(pages.Changed, match="4 such claims"):
        pages.page("p.in", small, full)
    claim = next(c for c in full.claims("u3_unseen_network") if c["below"] == 0.7)
    (tmp_path / "templates/p.in").write_text(several % (" < 0.7", claim["verdict"]))
    verdicts = [p["verdict"] for p in claim["places"] if p["verdict"] != "not compared"]
    assert len(verdicts) == 4
    assert f"{verdicts.count('holds')} of 4 hold below 0.7" in pages.page("p.in", small, full)
    (tmp_path / "templates/p.in").write_text("{{small a14_sampler_readings; multiscale:paper+by_pass + box; uniform + box; mse; fresh; holds}}")
    assert "results/experiments/a14" in pages.page("p.in", small, full)


def test_no_path_of_a_machine_is_kept():
    assert not [(path.name, found) for path in EVERY for text in kept.unpack(path).values() for found in re.findall(r'"(?:/|file:)[^"]*"', text)]


def test_what_is_kept_is_small():
    sizes = {p: p.stat().st_size for p in RESULTS.rglob("*") if p.is_file()}
    assert sum(size for p, size in sizes.items() if p.suffix == ".xz") <= MOST_BYTES
    assert len(EVERY) > 25


PLAN = """recordings = ["{}"]
spp = [4]
replicates = 3
pictures = false
samplers = ["uniform", "multiscale"]
filters = ["box", "gaussian"]
claim = [{{ better = "multiscale + box", than = "uniform + box", metric = "mse" }}]
"""


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("evaluated")
    subprocess.run([PROGRAM, "synth", "scene_s", "--size", "24", "--samples", "32", "--seed", "3", "-o", folder / "s.spool", "-q"], check=True)
    (folder / "plan.toml").write_text(PLAN.format(folder / "s.spool"))
    evaluate(folder / "plan.toml", "-o", folder / "results")
    return folder / "results"


def kept_lines(results):
    """Lines of results.jsonl with the counts and halves of their cells, which are found by their error."""
    cells = {}
    for cell in map(json.loads, cell_lines(results)):
        cells.setdefault((cell["fields"]["mse"], cell["fields"]["ssim"]), cell)
    for line in (results / "results.jsonl").read_text().splitlines():
        row = json.loads(line)
        cell = next(c for (mse, ssim), c in cells.items() if float(mse) == row["mse"] and float(ssim) == row["ssim"])
        yield {**row, **{k: cell[k] for k in ("counts", "halves") if k in cell}}


def judged(folder):
    evaluate("--statistics-only", folder)
    return json.loads((folder / "statistics.json").read_text())


def test_a_plan_that_cannot_be_run_leaves_no_results_of_the_last_run_to_be_kept(evaluated, tmp_path):
    plan, results = tmp_path / "plan.toml", tmp_path / "results"
    shutil.copytree(evaluated, results)
    plan.write_text(PLAN.format(evaluated.parent / "s.spool").replace("[4]", "[4, 64]"))  # the recording has 32
    with pytest.raises(kept.Failed, match="plan.toml stopped with exit code 1"):
        kept.evaluate(PROGRAM, plan, results)
    plan.write_text(PLAN.format(evaluated.parent / "s.spool"))
    kept.evaluate(PROGRAM, plan, results)
    assert kept.texts_of(results)["statistics.json"] == kept.texts_of(evaluated)["statistics.json"]


def test_a_plan_that_is_none_is_named(tmp_path):
    (tmp_path / "wrong.toml").write_text("spp = [4\nx")
    for name, words in ("wrong", "wrong.toml: .*line 2"), ("none", "none.toml: No such file"):
        with pytest.raises(kept.Failed, match=words):
            plans.read(tmp_path / f"{name}.toml")


@pytest.mark.parametrize("words, line", [
    (["--full", "--recording", "tours"], "--recording tours: there are scene_s, "), (["--recording", "torus"], "--recording and --again are of full size"),
    (["--write-only"], "quick.tar.xz: is cut or damaged"), (["E1", "--program", "/bin/false"], "spool synth stopped with exit code 1")])
def test_what_cannot_be_done_is_one_line(words, line, tmp_path):
    (tmp_path / "results/experiments").mkdir(parents=True)
    whole = (RESULTS / "experiments/quick.tar.xz").read_bytes()
    (tmp_path / "results/experiments/quick.tar.xz").write_bytes(whole[:len(whole) // 2])
    done = subprocess.run([sys.executable, "-c", "import sys; from pathlib import Path; from tools.study import kept, plans, study\n"
                           f"plans.make_recordings.__defaults__ = Path({str(tmp_path)!r}),\nkept.run(study.main)", "--output", tmp_path, "--results", tmp_path, *words],
                          cwd=ROOT, capture_output=True, text=True, timeout=LONGEST_RUN)
    assert done.returncode in (1, 2) and line in done.stderr.splitlines()[-1] and "Traceback" not in done.stderr, done.stderr


def test_lines_that_were_kept_are_judged_as_the_cells_were(evaluated, tmp_path):
    for name in ("plan.toml", "claims.json"):
        shutil.copy(evaluated / name, tmp_path)
    lines = list(kept_lines(evaluated))
    (tmp_path / "kept.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    assert judged(tmp_path) == json.loads((evaluated / "statistics.json").read_text())
    without = [{k: v for k, v in line.items() if k != "halves"} for line in lines]
    (tmp_path / "kept.jsonl").write_text("".join(json.dumps(line) + "\n" for line in without))
    assert judged(tmp_path)["claims"][0]["places"][0]["ratio"] != json.loads((evaluated / "statistics.json").read_text())["claims"][0]["places"][0]["ratio"]


def test_small_cells_are_judged_as_the_cells_were(evaluated, tmp_path):
    for name in ("plan.toml", "claims.json"):
        shutil.copy(evaluated / name, tmp_path)
    whole = json.loads((evaluated / "statistics.json").read_text())["claims"]
    claimed = kept.claimed_halves(whole)
    cells = {k: kept.small_cell(c, claimed=claimed.get(c["method"], ())) for k, c in kept.cells_in("".join(cell_lines(evaluated))).items()}
    (tmp_path / "cells").mkdir()
    (tmp_path / "cells" / "kept.jsonl").write_text(kept.cells_text(cells))
    found = judged(tmp_path)["claims"]
    assert [c["counts"] for c in found] == [c["counts"] for c in whole]
    for a, b in zip(found, whole):
        for p, q in zip(a["places"], b["places"]):
            assert p["ratio"] == pytest.approx(q["ratio"], rel=2e-3)
    assert any("halves" in c for c in cells.values())
    assert len(kept.cells_text(cells)) < 0.7 * sum(map(len, cell_lines(evaluated)))


def test_lines_that_cannot_be_understood_count_as_missing(evaluated, tmp_path):
    shutil.copy(evaluated / "plan.toml", tmp_path)
    first = next(line for line in kept_lines(evaluated) if (line["sampler"], line["filter"], line["replicate"]) == ("uniform", "box", 0))
    hostile = ["", "{", "[1, 2]", "7", '{"dump": 3, "spp": "x"}', "[" * 5000, '{"mse": "' + "9" * 400 + '"}', "\0", json.dumps({**first, "mse": {"a": 1}, "spp": [4]}),
               json.dumps({**first, "halves": {"mse": {"columns": -1, "cells": "1", "varying": ""}}, "counts": "4:-1"})]
    (tmp_path / "kept.jsonl").write_text("\n".join(hostile) + "\n")
    statistics = judged(tmp_path)
    assert [(e["sampler"], e["filter"], e["replicates"]) for e in statistics["results"]] == [("uniform", "box", 1)]
    assert statistics["claims"][0]["verdict"] == "not compared" and statistics["claims"][0]["after_results"] is True


def test_a_folder_of_lines_is_not_evaluated_into(evaluated, tmp_path):
    (tmp_path / "kept.jsonl").write_text("")
    finished = subprocess.run([PROGRAM, "evaluate", evaluated.parent / "plan.toml", "-o", tmp_path, "-q"], text=True, capture_output=True)
    assert finished.returncode == 2 and "holds no results that could be continued" in finished.stderr


@pytest.fixture
def small_full(tmp_path, monkeypatch):
    """A plan and two recordings of full size, both analytic and tiny."""
    (tmp_path / "plans/full_size").mkdir(parents=True)
    (tmp_path / "plans/p.toml").write_text(PLAN.format("pools/one.spool").replace("replicates = 3", "replicates = 8"))
    (tmp_path / "plans/full_size/p.toml").write_text('samplers = ["neyman"]\n')
    made = {name: ["scene_s", 16, 32, seed] for seed, name in enumerate(("one", "two"))}
    monkeypatch.setattr(plans, "FULL", {**plans.FULL, "analytic": made, "recordings": ["one", "two", "elsewhere"], "replicates": 3})
    monkeypatch.setattr(plans, "PLANS", tmp_path / "plans")
    return full_size.Store(PROGRAM, tmp_path / "scratch", tmp_path / "kept")


def test_what_stands_under_instead_replaces_a_key_of_the_plan_and_claims_without_their_sampler_go(small_full, tmp_path):
    (tmp_path / "plans/full_size/p.toml").write_text('replicates = 2\n[instead]\nspp = [2]\nsamplers = ["uniform"]\n')
    plan = plans.full_plan("p", ["one.spool"])
    assert (plan["replicates"], plan["spp"], plan["samplers"], plan["claim"]) == (2, [2], ["uniform"], []) and "instead" not in plan


def test_full_size_is_measured_recording_by_recording_and_judged_together(small_full, tmp_path):
    assert small_full.measure("p", "one") and not small_full.measure("p", "one")
    assert not small_full.measure("p", "elsewhere")
    store = pages.Kept(tmp_path / "kept")
    assert [p["dump"] for p in store.claims("p")[0]["places"]] == ["one"]
    assert small_full.measure("p", "two")
    texts = kept.unpack(tmp_path / "kept/p.tar.xz")
    statistics = json.loads(texts["statistics.json"])
    assert [p["dump"] for p in statistics["claims"][0]["places"]] == ["one", "two"]
    assert "after_results" not in statistics["claims"][0]
    assert {e["sampler"] for e in statistics["results"]} == {"uniform", "multiscale", "neyman"}
    assert {e["replicates"] for e in statistics["results"]} == {3} and str(tmp_path) not in texts["plan.toml"] + texts["statistics.json"]
    assert small_full.measure("p", "one", again=True)
    assert json.loads(kept.unpack(tmp_path / "kept/p.tar.xz")["statistics.json"])["claims"] == statistics["claims"]


def test_a_recording_that_is_no_longer_asked_for_goes(small_full, tmp_path, monkeypatch):
    for name in ("one", "two"):
        small_full.measure("p", name)
    archive = tmp_path / "kept/p.tar.xz"
    kept.pack(archive, {**kept.unpack(archive), "figures.json": '[{"dump":"one"}]', "kept.jsonl": '{"dump":"one","sampler":"neyman","filter":"box","spp":2,"threads":0,"replicate":0,"mse":1}\n'})
    monkeypatch.setattr(plans, "FULL", {**plans.FULL, "recordings": ["two"]})
    small_full.judge("p")
    texts = kept.unpack(archive)
    assert list(json.loads(texts["made.json"])) == ["two"] and not {"kept.jsonl", "figures.json", "cells/one.jsonl"} & set(texts)
    assert [p["dump"] for p in pages.Kept(tmp_path / "kept").claims("p")[0]["places"]] == ["two"]


def test_recordings_of_a_group_are_judged_together(small_full, tmp_path, monkeypatch):
    monkeypatch.setattr(plans, "FULL", {**plans.FULL, "analytic": {f"g_{i}": ["scene_s", 16, 32, i] for i in (1, 2)}, "groups": {"g": 2}, "alone": ["p"]})
    plan = tmp_path / "plans/p.toml"
    plan.write_text(PLAN.format("g").replace("replicates = 3", "replicates = 1"))
    assert plans.full_recordings("p") == ["g_1", "g_2"]
    for name in plans.full_recordings("p"):
        assert small_full.measure("p", name) and not small_full.measure("p", name)
    kept_of = pages.Kept(tmp_path / "kept")
    assert [p["dump"] for p in kept_of.claims("p")[0]["places"]] == ["g_1"], "a group has the name of its first recording"
    assert {e["replicates"] for e in kept_of.json("p", "statistics.json")["results"]} == {2}


def test_a_claim_that_is_added_later_is_marked(small_full, tmp_path):
    small_full.measure("p", "one")
    plan = tmp_path / "plans/p.toml"
    plan.write_text(plan.read_text().replace("claim = [", 'claim = [{ better = "uniform + gaussian", than = "uniform + box" },'))
    assert not small_full.measure("p", "one")
    small_full.judge("p")
    marks = {c["better"]: c.get("after_results", False) for c in pages.Kept(tmp_path / "kept").claims("p")}
    assert marks == {"uniform + gaussian": True, "multiscale + box": False}


@pytest.mark.parametrize("name", sorted(p.stem for p in (ROOT / "tools/plans/full_size").glob("*.toml")))
def test_a_plan_at_full_size_is_understood(name, tmp_path):
    plan = plans.full_plan(name, [ROOT / "dumps/tiny/table.spool"])
    labels = {f"{s[0]} + {f[0]}" for s in methods_of(plan, "sampler") for f in methods_of(plan, "filter")}
    assert {c[k] for c in plan.get("claim", ()) for k in ("better", "than")} <= labels
    (tmp_path / "plan.toml").write_text(plans.text_of(plan))
    evaluate(tmp_path / "plan.toml", "--dry-run")


def test_a_plan_text_is_the_plan():
    for path in plans.PLANS.rglob("*.toml"):
        assert plans.tomllib.loads(plans.text_of(plans.read(path))) == plans.read(path), path


def test_curves_are_drawn_of_the_methods_that_claims_name(tmp_path):
    from tools.study import plots
    statistics = pages.Kept(RESULTS / "experiments_full").json("e7_tiles", "statistics.json")
    curves = plots.curves_of(statistics)
    assert list(curves) == ["scene_s"] and {spp for points in curves["scene_s"].values() for spp, *_ in points} == {4, 16}
    statistics["claims"] = statistics["claims"][:1]
    assert set(plots.curves_of(statistics)["scene_s"]) == {statistics["claims"][0]["better"], statistics["claims"][0]["than"]}
    plots.draw_pages(curves, plots.METRIC, lambda after: tmp_path / f"c{after}", times=(False,))
    assert (tmp_path / "c.svg").read_text().startswith("<?xml") and not (tmp_path / "c_time.svg").exists()


class Made:
    def __init__(self, curves):
        self.curves = curves

    def json(self, plan, name):
        return self.curves if name == "curves.json" else {}


def test_equal_time_prints_ratios_and_leaves_out_budgets_where_every_method_is_too_slow():
    slow, read = {"at": 4.0, "seconds": 0.1, "outside": "too slow"}, {"at": 8.0, "seconds": 0.2, "ratio": [0.5, 0.4, 0.6]}
    curves = [{"dump": "d", "sampler": "uniform", "filter": f, "equal_time": at} for f, at in (("a", [slow, read]), ("b", [slow, {**read, "ratio": [0.7]}]), ("c", [read]))]
    lines = pages.equal_time(Made(curves), {"uniform + a": "a", "uniform + b": "b"}, "p").splitlines()
    assert lines[0] == "| recording | spp | a | b |" and lines[2:] == ["| d | 8 | 0.500 [0.400, 0.600] | 0.700 |"]


def test_a_method_by_description_is_marked():
    claim = {"text": "t", "better": "multiscale:paper{a=1} + box", "than": "mitchell{x=2} + box", "metric": "mse", "below": 1.0, "samples": "own",
             "verdict": "holds", "counts": {"holds": 2}}
    assert "| t [R] | holds 2/0/0 |" in tables.claims_table({"p": [claim]}, {"mitchell"})
    assert "| t | holds 2/0/0 |" in tables.claims_table({"p": [claim]}, {"mitchell2", "multi"})
