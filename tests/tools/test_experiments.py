"""What the page of experiments is written with: labels, ratios with their errors, verdicts, stand-ins."""
import json
import math
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
from methods import methods_of  # noqa: E402
from inference import Interval, mean_of, order_of, ratio_of, use_program  # noqa: E402
from results import Results, canonical  # noqa: E402
from tables import finding, with_interval  # noqa: E402

use_program(os.environ.get("SPOOL_PROGRAM", "spool"))


def test_labels_are_alike_in_whatever_order_options_were_given():
    assert canonical("a:p{b=2,a=1}") == canonical("a:p{a=1,b=2}") == "a:p{a=1,b=2}"
    plan = {"samplers": ["uniform"], "sampler": [{"name": "multiscale", "preset": "paper", "alpha": [0.3, 0.4]}]}
    assert [m[0] for m in methods_of(plan, "sampler")] == ["uniform", "multiscale:paper{alpha=0.3}",
                                                           "multiscale:paper{alpha=0.4}"]


def test_series_are_judged_by_the_program():
    a, b = [1.0, 1.1, 0.9, 1.05, 0.95], [2.0, 2.1, 1.9, 1.9, 2.1]
    found = mean_of(a)
    assert found.mean == pytest.approx(math.exp(sum(map(math.log, a)) / 5)) and found.low < found.mean < found.high
    assert mean_of([-1.0, 2.0, 4.0], positive=False).mean == pytest.approx(5 / 3)
    assert ratio_of(a, b).mean == pytest.approx(mean_of(a).mean / mean_of(b).mean)
    assert math.isnan(ratio_of(a, []).mean) and math.isnan(mean_of([]).mean)


def test_an_order_is_claimed_beyond_the_paired_noise_only():
    assert order_of([1.0, 2.0, 3.0], [1.1, 2.2, 3.3001]) == -1  # every replicate below by nearly the same factor
    assert order_of([1.0, 2.0, 3.0], [3.0, 2.0, 1.1]) == 0
    assert order_of([1.0], [2.0]) is None and order_of([], []) is None


def test_figures_are_shown_with_their_intervals():
    assert with_interval(Interval(0.123456, 0.11, 0.14)) == "0.123 [0.110, 0.140]"
    assert with_interval(Interval(1.0)) == "1.00" and with_interval(Interval()) == "–"


def statistics(verdict):
    methods = [{"sampler": s, "filter": "box", "compared": True} for s in ("new{b=1,a=2}", "uniform")]
    methods[1]["against_best"] = "worse"
    return {"version": 1, "overall": [], "results": [
        {"dump": "d/scene.spool", "spp": 4.0, "threads": 0, "sampler": "uniform", "filter": "box",
         "quantities": {"mse": [1.0, 0.9, 1.1]}}],
        "conditions": [{"dump": "d/scene.spool", "spp": 4.0, "threads": 0, "metric": "mse", "ranking": methods,
                        "pairs": [[0, 1, 0.5, 0.4, 0.6, 0.01, verdict]]}]}


@pytest.fixture
def results(tmp_path):
    rows = [{"dump": "d/scene.spool", "sampler": sampler, "filter": f, "spp": 4.0, "threads": 0, "replicate": r,
             "mse": value + 0.01 * r, "error": "broken" if f == "bad" else ""}
            for sampler, value in (("uniform", 1.0), ("new{b=1,a=2}", 0.5)) for f in ("box", "bad") for r in (2, 0, 1)]
    (tmp_path / "results.jsonl").write_text("\n".join(json.dumps(row) for row in rows))
    (tmp_path / "statistics.json").write_text(json.dumps(statistics("better")))
    return Results([tmp_path])


def test_replicates_are_in_order_and_failures_apart(results):
    assert results.values("mse", "scene", "uniform", "box", 4) == [1.0, 1.01, 1.02]
    assert results.values("mse", "scene", "uniform", "bad", 4) == [] and len(results.failed) == 2
    assert results.only({"uniform"}, {"box"}).samplers == ["uniform"]


def test_verdicts_and_figures_are_those_of_the_file(results, tmp_path):
    new, uniform = ("new{a=2,b=1}", "box"), ("uniform", "box")
    assert results.order("mse", "scene", 4, new, uniform) == -1 and results.order("mse", "scene", 4, uniform, new) == 1
    assert results.ratio("mse", "scene", 4, uniform, new)[:3] == pytest.approx((2.0, 1 / 0.6, 2.5))
    assert results.figure("mse", "scene", *uniform, 4)[:3] == (1.0, 0.9, 1.1)
    assert [m for m, _ in results.ranked("mse", "scene", 4)] == [new, uniform]
    (tmp_path / "statistics.json").write_text(json.dumps(statistics("undecided")))
    assert Results([tmp_path]).order("mse", "scene", 4, new, uniform) == 0  # whatever the rows say


def test_a_statement_agrees_disagrees_or_is_not_measured(results):
    new, uniform = ("new{a=2,b=1}", "box"), ("uniform", "box")
    assert "agrees. Scene: below at 4 spp." in finding("new is below uniform", results, new, uniform)
    assert "**disagrees**" in finding("uniform is below new", results, uniform, new)
    assert "not measured" in finding("bad is below new", results, ("uniform", "bad"), new)
