"""`spool compare BEFORE AFTER`: what it claims, and its exit code."""
import json

import pytest

from conftest import samples, write_dump

PLAN = """
recordings = ["scene.spool"]
spp = [2, 4, 8]
replicates = 6
seed = {seed}
filters = ["box"]
samplers = ["uniform"]
pictures = false
[[filter]]
name = "gaussian"
"""


@pytest.fixture
def evaluate(good, dump, tmp_path):
    def make(name, seed=1, plan=PLAN):
        (tmp_path / f"{name}.toml").write_text(plan.format(seed=seed))
        good("evaluate", f"{name}.toml", "-o", name)
        return name
    return make


def change(tmp_path, folder, cells, factor):
    """As if a later program had made this: the errors of some cells times `factor`."""
    for path in sorted((tmp_path / folder / "cells").iterdir()):
        cell = json.loads(path.read_text())
        if cells(cell):
            cell["fields"]["relmse"] = repr(float(cell["fields"]["relmse"]) * factor)
            path.write_text(json.dumps(cell))


def test_the_same_results_are_identical(good, evaluate):
    a, b = evaluate("a"), evaluate("b")
    out = good("compare", a, b, "--metric", "relmse,mse").out
    assert "12 comparisons" in out and "12 identical" in out


def test_another_seed_is_not_told_apart(good, evaluate):
    found = good("compare", evaluate("a"), evaluate("b", seed=2), "--json").json
    assert {c["verdict"] for c in found["comparisons"]} == {"same"}
    assert not any(c["paired"] for c in found["comparisons"])


def test_what_became_worse_sets_the_exit_code(run, good, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")
    change(tmp_path, "b", lambda cell: True, 1.5)
    finished = run("compare", a, b)
    assert finished.code == 1 and "worse" in finished.out and "6 worse" in finished.err
    assert "6 better" in good("compare", b, a).out
    assert "0 worse" in good("compare", a, b, "--tolerance", 0.6).out
    assert "6 identical" in good("compare", a, b, "--metric", "mse").out
    found = run("compare", a, b, "--json").json["comparisons"]
    for c in found:
        assert c["paired"] and c["low"] > 0 and c["after"] == pytest.approx(1.5 * c["before"])


def test_failures_and_gaps_are_told(run, good, evaluate, tmp_path):
    a = evaluate("a")
    evaluate("b")
    broken = sorted((tmp_path / "b" / "cells").iterdir())[0]
    cell = json.loads(broken.read_text())
    cell["fields"] = {"error": "broken on purpose"}
    broken.write_text(json.dumps(cell))
    finished = run("compare", a, "b")
    assert finished.code == 1 and "failed now: scene" in finished.out
    evaluate("c", plan=PLAN.replace("[2, 4, 8]", "[2, 4]"))
    finished = run("compare", a, "c")
    assert finished.code == 1 and "only before" in finished.out
    assert "only after" in good("compare", "c", a).out


def test_times_are_compared_by_name_only(run, evaluate):
    a = evaluate("a")
    assert {c["metric"] for c in run("compare", a, a, "--json").json["comparisons"]} == {"relmse"}
    found = run("compare", a, a, "--json", "--metric", "cpu").json["comparisons"]
    assert {c["metric"] for c in found} == {"cpu"} and {c["verdict"] for c in found} == {"identical"}


def test_wrong_use(run, evaluate, tmp_path):
    a = evaluate("a")
    run("compare", a, "none").failed_with(3, "plan.toml")
    run("compare", a, a, "--metric", "relmze").failed_with(2, "did you mean 'relmse'")
    write_dump(tmp_path / "third.spool", samples(seed=9)[0])
    evaluate("d", plan=PLAN.replace("scene.spool", "third.spool"))
    run("compare", a, "d").failed_with(1, "no result in common")


def test_statistics_have_ranks_pairs_slopes_and_samples(evaluate, tmp_path):
    # Large enough for sixteen blocks: from four of them little can be said.
    (tmp_path / "scene.spool").unlink()
    radiance, reference = samples(height=64, width=64)
    write_dump(tmp_path / "scene.spool", radiance, reference=reference[..., None].repeat(3, axis=2).astype("<f4"))
    evaluate("a")
    found = json.loads((tmp_path / "a" / "statistics.json").read_text())
    at_8 = next(c for c in found["conditions"] if c["spp"] == 8 and c["metric"] == "mse")
    assert [r["rank"] for r in at_8["ranking"]] == [1, 2] and not at_8["biased"]
    pair, = at_8["pairs"]
    assert pair["low"] <= pair["difference"] <= pair["high"] < 0 and pair["p_holm"] >= pair["p"]
    box = next(c for c in found["curves"] if c["filter"] == "box" and c["metric"] == "mse")
    assert -1.3 < box["slope"] < -0.7 and box["slope_low"] < box["slope"] < box["slope_high"]
    gaussian = next(c for c in found["curves"] if c["filter"] == "gaussian" and c["metric"] == "mse")
    needed = gaussian["samples_for_the_error_of_uniform_box"]
    assert [n["at"] for n in needed] == [2, 4, 8]
    assert all(n["low"] <= n["spp"] <= n["high"] for n in needed)


def test_a_biased_reference_is_marked_everywhere(good, run, dump, tmp_path):
    good("evaluate", dump, "--spp", "2,4", "--reference", "pool", "-o", "p", "--no-pictures")
    assert "BIASED" in good("compare", "p", "p").out
    assert all(c["biased"] for c in run("compare", "p", "p", "--json").json["comparisons"])
    statistics = json.loads((tmp_path / "p" / "statistics.json").read_text())
    assert all(c["biased"] for c in statistics["conditions"] + statistics["curves"])
    assert "pool (biased)" in (tmp_path / "p" / "results.csv").read_text()
    assert '"pool (biased)"' in (tmp_path / "p" / "results.jsonl").read_text().splitlines()[0]
