"""Experiments at full size: each recording's results are kept small, several machines add to one page, what changed is said."""
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
import full_page  # noqa: E402
import full_size  # noqa: E402
import measured  # noqa: E402
from chapter import Chapter  # noqa: E402
from inference import Interval, use_program  # noqa: E402
from results import Results  # noqa: E402
from tables import curves, finding  # noqa: E402

PROGRAM = os.environ.get("SPOOL_PROGRAM", "spool")
use_program(PROGRAM)
OURS, UNIFORM = ("multiscale", "box"), ("uniform", "box")
PLAN = """title = "small"
recordings = ["../../dumps/tiny/chess.spool", "../../dumps/tiny/table.spool"]
spp = [4]
replicates = 8
halves = false
pictures = true
samplers = ["multiscale", "uniform", "mitchell"]
filters = ["box", "gaussian", "cross_bilateral"]
"""


def synth(path, seed):
    path.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([PROGRAM, "synth", "scene_s", "--size", "24", "--samples", "64", "--seed", str(seed), "-o", path, "-q"], check=True)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Two recordings, as of chess and table at full size."""
    folder = tmp_path_factory.mktemp("recorded")
    synth(folder / "chess_256.spool", 1)
    synth(folder / "table_256.spool", 2)
    return folder


@pytest.fixture
def place(tmp_path, monkeypatch, recorded):
    """A function that makes a machine with some recordings; all share plans and what is kept."""
    monkeypatch.setattr(full_size, "OTHERS", ())
    monkeypatch.setattr(full_size, "commit", lambda: "abc 2026-01-01")
    plans = tmp_path / "plans"
    plans.mkdir()
    (plans / "small.toml").write_text(PLAN)

    def machine(name, *recordings):
        folder = tmp_path / name / "recordings"
        folder.mkdir(parents=True, exist_ok=True)
        for recording in recordings:
            shutil.copy(recorded / f"{recording}.spool", folder)
        monkeypatch.setattr(full_size, "RECORDINGS", folder)
        return full_size.Measuring(PROGRAM, plans, tmp_path / name / "scratch", tmp_path / "kept")
    return machine


def page_of(measuring, small="# Small\n"):
    def body(m):
        return [*(curves(m.results, p) for p in m.results.pools), finding("ours is below uniform in MSE", m.results, OURS, UNIFORM)]
    chapter = Chapter("E2", "Title", ["small"], "what?", body)
    return "\n\n".join(full_page.blocks([chapter], measuring, small))


def test_what_is_kept_says_what_the_folder_says(place):
    machine = place("one", "chess_256")
    assert machine.measure("small", "chess_256", False)
    kept = machine.kept("small", "chess_256")
    folder = next(p for p in (machine.scratch / "small/chess_256").iterdir() if p.is_dir())
    whole, small = Results([folder]), Results([kept])
    assert small.samplers == whole.samplers and small.budgets == whole.budgets and small.pools == whole.pools == ["chess_256"]
    methods = [(s, f) for s in whole.samplers for f in ("box", "gaussian")]
    for m in methods:
        assert small.values("mse", "chess_256", *m, 4) == whole.values("mse", "chess_256", *m, 4)
        for column in ("mse", "relmse", "energy_ratio"):
            assert small.figure(column, "chess_256", *m, 4)[:3] == pytest.approx(whole.figure(column, "chess_256", *m, 4)[:3], rel=1e-5)
        for other in methods:
            for column in ("mse", "relmse"):
                assert small.order(column, "chess_256", 4, m, other) == whole.order(column, "chess_256", 4, m, other)
                assert small.ratio(column, "chess_256", 4, m, other)[:3] == pytest.approx(
                    whole.ratio(column, "chess_256", 4, m, other)[:3], rel=1e-3, nan_ok=True)
    assert {k[2] for k in small.failed} == {"cross_bilateral"} == {k[2] for k in whole.failed}  # needs features
    assert [m for m, _ in small.ranked("mse", "chess_256", 4)] == [m for m, _ in whole.ranked("mse", "chess_256", 4)]
    assert kept.stat().st_size < 12e3


def test_pairs_are_kept_whichever_method_stands_first(tmp_path):
    methods = [{"sampler": s, "filter": "box", "compared": True} for s in ("best", "worst")]
    condition = {"dump": "d/x.spool", "spp": 4.0, "threads": 0, "metric": "mse", "ranking": methods, "pairs": [[1, 0, 2.0, 1.6, 2.5, 0.01, "worse"]]}
    (tmp_path / "statistics.json").write_text(json.dumps({"version": 1, "results": [], "conditions": [condition], "overall": []}))
    rows = [{"dump": "d/x.spool", "sampler": s, "filter": "box", "spp": 4.0, "threads": 0, "replicate": 0, "mse": 1.0, "error": ""} for s in ("best", "worst")]
    (tmp_path / "results.jsonl").write_text("\n".join(map(json.dumps, rows)))
    measured.keep(tmp_path, {"recording": "x", "described": []}, tmp_path / "kept.jsonl")
    kept, a, b = Results([tmp_path / "kept.jsonl"]), ("best", "box"), ("worst", "box")
    assert kept.order("mse", "x", 4, a, b) == -1 and kept.order("mse", "x", 4, b, a) == 1
    assert kept.ratio("mse", "x", 4, a, b)[:3] == pytest.approx((0.5, 0.4, 0.625)) and kept.ratio("mse", "x", 4, b, a).mean == pytest.approx(2.0)


def test_machines_add_to_one_page(place):
    first = place("one", "chess_256")
    assert first.measure("small", "chess_256", False) and not first.measure("small", "table_256", False)
    text = page_of(first)
    assert "Recordings: chess. Not measured yet: table." in text and "Measured by spool" in text
    assert "[R] marks" in text  # mitchell is by description
    second = place("two", "table_256")
    before = first.kept("small", "chess_256").read_bytes()
    assert second.measure("small", "table_256", False)
    assert first.kept("small", "chess_256").read_bytes() == before
    text = page_of(second)
    assert "Recordings: chess, table." in text and "Not measured yet" not in text and "**older:**" not in text
    assert text.index("chess, mse") < text.index("table, mse")


def test_what_was_measured_is_not_measured_again(place):
    machine = place("one", "chess_256")
    assert machine.measure("small", "chess_256", False)
    assert not machine.measure("small", "chess_256", False)
    other = place("two", "chess_256")  # a machine that has nothing but the tree and the recording
    assert not other.measure("small", "chess_256", False)
    synth(full_size.RECORDINGS / "chess_256.spool.new", 7)
    os.replace(full_size.RECORDINGS / "chess_256.spool.new", full_size.RECORDINGS / "chess_256.spool")
    assert other.measure("small", "chess_256", False), "other samples are another recording"


def test_of_two_plans_that_ask_the_same_one_is_measured(place, monkeypatch):
    machine = place("one", "chess_256")
    (machine.plans / "twin.toml").write_text(PLAN.replace('"small"', '"of another title"'))
    assert machine.measure("small", "chess_256", False)
    monkeypatch.setattr(full_size, "evaluate", None)  # to be called by none
    assert machine.measure("twin", "chess_256", False)
    (head, *lines), (other, *others) = (machine.kept(p, "chess_256").read_text().split("\n") for p in ("small", "twin"))
    assert lines == others and json.loads(other) == {**json.loads(head), "plan": "twin"}
    (machine.plans / "twin.toml").write_text(PLAN.replace("spp = [4]", "spp = [2]"))
    with pytest.raises(TypeError):
        machine.measure("twin", "chess_256", False)


def test_results_of_an_older_program_or_plan_are_marked(place, monkeypatch):
    machine = place("one", "chess_256", "table_256")
    machine.measure("small", "chess_256", False)
    monkeypatch.setattr(full_size, "commit", lambda: "def 2026-02-01")
    machine.measure("small", "table_256", False)
    text = page_of(machine)
    assert "Measured by spool" in text and "def 2026-02-01; **older:** chess by spool" in text and "**By an older plan" not in text
    (machine.plans / "small.toml").write_text(PLAN.replace("spp = [4]", "spp = [8]"))
    assert "**Measured before the plan changed:** chess, table." in page_of(machine)
    assert machine.measure("small", "chess_256", False)
    assert "**Measured before the plan changed:** table." in page_of(machine)


def test_a_plan_gets_more_methods_and_keys_at_full_size(place):
    machine = place("one")
    (machine.plans / "full_size").mkdir()
    (machine.plans / "full_size/small.toml").write_text('# More.\nfresh = true\n[[sampler]]\nname = "multiscale"\npreset = "paper"\n')
    text = full_size.plan_text(machine.plans / "small.toml", "/somewhere/chess_256.spool")
    import tomllib
    plan = tomllib.loads(text)
    assert plan["recordings"] == ["/somewhere/chess_256.spool"] and plan["fresh"] and not plan["pictures"]
    assert plan["replicates"] == full_size.REPLICATES and plan["sampler"] == [{"name": "multiscale", "preset": "paper"}]
    assert full_size.plan_hash(text) == full_size.plan_hash(text.replace("/somewhere", "/elsewhere"))


def test_every_plan_of_the_tree_has_a_text_at_full_size():
    plans = ROOT / "tools/plans"
    for path in [*plans.glob("[ea][0-9]*.toml"), plans / "methods.toml", plans / "features.toml"]:
        full_size.plan_hash(full_size.plan_text(path, "x.spool"))
    assert all((plans / path.name).exists() for path in (plans / "full_size").glob("*.toml"))


def test_of_many_methods_some_ratios_are_left_out():
    from measured import ALL_RATIOS, SOME_RATIOS, keeps_ratio
    box, other, third = ("uniform", "box"), ("multiscale", "directional"), ("mitchell", "gaussian")
    same_sampler = ("multiscale", "gaussian")
    assert keeps_ratio(ALL_RATIOS, other, third) and not keeps_ratio(ALL_RATIOS + 1, other, third)
    assert keeps_ratio(SOME_RATIOS, other, same_sampler) and keeps_ratio(SOME_RATIOS, same_sampler, third)
    assert not keeps_ratio(SOME_RATIOS + 1, other, same_sampler) and keeps_ratio(SOME_RATIOS + 1, third, box)


def test_twins_of_a_scene_are_found_by_their_names(tmp_path):
    from resolution import twins
    files = []
    for name in ("chess_256", "chess_512", "torus", "cornell_box_picture", "cornell_box_picture_512", "scene_s_512"):
        files.append(tmp_path / f"{name}.jsonl")
        files[-1].write_text(json.dumps({"measured": 1, "recording": name}) + "\n")
    assert [(a.stem, b.stem) for a, b in twins(files)] == [("chess_256", "chess_512"), ("cornell_box_picture", "cornell_box_picture_512")]


def test_ratios_that_are_not_kept_are_made_from_replicates(place):
    machine = place("one", "chess_256")
    machine.measure("small", "chess_256", False)
    results, known = Results(machine.sources("small")), Results(machine.sources("small"))
    for pairs in results._pairs.values():  # those to uniform + box as if replicates shared samples
        pairs.update({pair: (verdict, Interval(r.mean, r.low ** 2 / r.mean, r.high ** 2 / r.mean) if UNIFORM in pair else Interval())
                      for pair, (verdict, r) in pairs.items()})
    looked_at = 0
    for (pool, spp, threads, column), pairs in known._pairs.items():
        for (a, b), (_, ratio) in pairs.items():
            made = results.ratio_or_made(column, pool, spp, a, b, threads)
            if ratio.mean == ratio.mean and ratio.high > ratio.low:
                assert made.mean == pytest.approx(ratio.mean, rel=1e-3)
                assert 1.9 < math.log(made.high / made.low) / math.log(ratio.high / ratio.low) < 2.2, (a, b)
                looked_at += UNIFORM not in (a, b)
    assert looked_at == 20
    same = [row for key, rows in results._rows.items() if key[1:3] == ("mitchell", "box") for row in rows]
    for row, uniform in zip(same, results.rows("chess_256", *UNIFORM, 4)):
        row.update(mse=uniform["mse"], mse_fresh=2.0 + row["replicate"] % 3)
    for row in results.rows("chess_256", *OURS, 4):
        row["mse_fresh"] = 1.0 + row["replicate"] % 3
    made = results.ratio_or_made("mse_fresh", "chess_256", 4, OURS, ("mitchell", "box"), None)
    assert made.low < made.mean < 1, "a method that took the samples of uniform + box is compared, too"


def test_a_file_of_another_format_counts_as_missing(tmp_path):
    path = tmp_path / "x.jsonl"
    assert measured.read_head(path) is None
    path.write_text(json.dumps({"measured": 0}) + "\n")
    assert measured.read_head(path) is None


def test_what_is_in_the_tree_is_small():
    files = list((ROOT / "docs/results/experiments_full/measured").glob("*/*.jsonl"))
    assert sum(f.stat().st_size for f in files) < 75e3 * len(files) and all(f.stat().st_size < 500e3 for f in files)
