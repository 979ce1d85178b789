"""What the page of experiments is written with: labels, ratios with their errors, verdicts, stand-ins."""
import json
import math
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
from methods import methods_of  # noqa: E402
from results import Results, canonical, order, ratio  # noqa: E402
from tables import finding, with_error  # noqa: E402


def test_labels_are_alike_in_whatever_order_options_were_given():
    assert canonical("a:p{b=2,a=1}") == canonical("a:p{a=1,b=2}") == "a:p{a=1,b=2}"
    plan = {"samplers": ["uniform"], "sampler": [{"name": "multiscale", "preset": "paper", "alpha": [0.3, 0.4]}]}
    assert [m[0] for m in methods_of(plan, "sampler")] == ["uniform", "multiscale:paper{alpha=0.3}",
                                                           "multiscale:paper{alpha=0.4}"]


def test_a_ratio_of_means_has_the_error_of_the_delta_method():
    a, b = [1.0, 1.1, 0.9, 1.05, 0.95], [2.0, 2.1, 1.9, 1.9, 2.1]
    value, error = ratio(a, b)
    residuals = [x - value * y for x, y in zip(a, b)]
    expected = math.sqrt(sum(r * r for r in residuals) / 4 / 5) / (sum(b) / 5)
    assert value == sum(a) / sum(b) and error == pytest.approx(expected, rel=0.02)


def test_an_order_is_claimed_beyond_the_paired_noise_only():
    assert order([1.0, 2.0, 3.0], [1.1, 2.1, 3.1001]) == -1  # every replicate below by nearly the same
    assert order([1.0, 2.0, 3.0], [3.0, 2.0, 1.1]) == 0
    assert order([1.0], [2.0]) is None and order([], []) is None


def test_values_have_as_many_places_as_their_errors():
    assert with_error(0.123456, 0.0021) == "0.1235 ± 0.0021"
    assert with_error(1.0, 0.0) == "1.000"


@pytest.fixture
def results(tmp_path):
    rows = [{"dump": "d/scene.spool", "sampler": sampler, "filter": f, "spp": 4.0, "threads": 0, "replicate": r,
             "mse": value + 0.01 * r, "error": "broken" if f == "bad" else ""}
            for sampler, value in (("uniform", 1.0), ("new{b=1,a=2}", 0.5)) for f in ("box", "bad") for r in (2, 0, 1)]
    (tmp_path / "results.jsonl").write_text("\n".join(json.dumps(row) for row in rows))
    return Results([tmp_path])


def test_replicates_are_in_order_and_failures_apart(results):
    assert results.values("mse", "scene", "uniform", "box", 4) == [1.0, 1.01, 1.02]
    assert results.values("mse", "scene", "uniform", "bad", 4) == [] and len(results.failed) == 2
    assert results.only({"uniform"}, {"box"}).samplers == ["uniform"]


def test_a_statement_agrees_disagrees_or_is_not_measured(results):
    new, uniform = ("new{a=2,b=1}", "box"), ("uniform", "box")
    assert "agrees. Scene: below at 4 spp." in finding("new is below uniform", results, new, uniform)
    assert "**disagrees**" in finding("uniform is below new", results, uniform, new)
    assert "not measured" in finding("bad is below new", results, ("uniform", "bad"), new)
