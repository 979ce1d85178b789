"""What a verdict may stand on, and what is printed of it: withheld verdicts, groups, baselines, claims, equal time."""
import json
import shutil

import numpy as np
import pytest

from conftest import samples, write_dump
from results_comparison import changed_cells

PLAN = 'spp = [2, 4]\nreplicates = 4\npictures = false\nsamplers = ["uniform"]\nfilters = ["box", "gaussian"]\n'


def made(path, seed, lamp=0.0):
    """A recording whose pixel 5, 5 is as bright as `lamp` in one of 16 samples."""
    radiance, mean = samples(seed=seed)
    radiance[5, 5, seed % 16] += np.float32(lamp)
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    reference[5, 5] += lamp / 16
    return write_dump(path, radiance, reference=reference, reference_variance=0 * reference)


def evaluate(good, tmp_path, plan, name="out", *options):
    (tmp_path / f"{name}.toml").write_text(plan)
    finished = good("evaluate", f"{name}.toml", "-o", name, *options)
    return json.loads((tmp_path / name / "statistics.json").read_text()), finished.out


def conditions(statistics, metric):
    return [c for c in statistics["conditions"] if c["metric"] == metric]


@pytest.fixture
def lamps(tmp_path):
    return [made(tmp_path / f"lamp{n}.spool", n, 1e4) for n in range(3)]


def test_an_error_of_one_pixel_has_no_verdict_until_three_recordings_show_it(good, tmp_path, lamps):
    statistics, _ = evaluate(good, tmp_path, 'recordings = ["lamp0.spool"]\n' + PLAN, "halves")
    shown = [e for c in conditions(statistics, "mse") for e in c["ranking"] if e["filter"] == "box"]
    assert shown and all("withheld" not in e and e["value"][2] > 1.2 * e["value"][1] for e in shown)  # measured, and wide
    statistics, text = evaluate(good, tmp_path, 'halves = false\nrecordings = ["lamp0.spool"]\n' + PLAN, "out", "--wide")
    for entry in (e for c in conditions(statistics, "mse") for e in c["ranking"]):
        if entry["filter"] == "box":
            assert entry["withheld"] == "few pixels" and len(entry["value"]) == 1 and not entry["compared"]
    results = [r for r in statistics["results"] if r["filter"] == "box"]
    assert all(r["quantities"]["mse_half_pixels"][0] <= 2 and r["quantities"]["mse_worst_share"][0] > 0.5 for r in results)
    assert all("relmse_trimmed" in r["quantities"] and len(r["quantities"]["relmse_trimmed"]) == 3 for r in results)
    assert "No verdict on MSE (few pixels)" in text and "three times" in text and "Few pixels: " in text
    group = "\n".join(f'[[dump]]\nfile = "lamp{n}.spool"\ngroup = "lamp"' for n in range(3))
    statistics, text = evaluate(good, tmp_path, PLAN + group, "group")
    for condition in conditions(statistics, "mse"):
        assert condition["about"]["kind"] == "recordings" and "spread between these" in condition["about"]["text"]
        assert all("withheld" not in e and len(e["value"]) == 3 for e in condition["ranking"])
    # Student's interval of three numbers, the means of the recordings' logarithms.
    rows = [json.loads(line) for line in (tmp_path / "group" / "results.jsonl").read_text().splitlines()]
    for result in statistics["results"]:
        logs = [np.log([r["mse"] for r in rows if (r["dump"], r["filter"], r["spp"]) == (f"lamp{n}", result["filter"], result["spp"])])
                for n in range(3)]
        means = np.mean(logs, axis=1)
        mean, low, high = np.log(result["quantities"]["mse"])
        assert np.isclose(mean, means.mean())
        assert np.isclose((high - low) / 2, 4.30265273 * means.std(ddof=1) / np.sqrt(3), rtol=1e-6)


def test_a_noisy_reference_withholds_relmse_and_not_mse(good, tmp_path):
    radiance, mean = samples(seed=2)
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    for name, noise in (("short", 0.1), ("long", 0.001)):
        write_dump(tmp_path / f"{name}.spool", radiance, reference=reference, reference_variance=np.full_like(reference, noise * 0.3))
    statistics, text = evaluate(good, tmp_path, 'recordings = ["short.spool", "long.spool"]\n' + PLAN)
    for result in statistics["results"]:
        level = result["quantities"]["relmse_reference_noise"][0]
        assert (level > 0.01) == (result["dump"] == "short.spool"), level
    for condition in conditions(statistics, "relmse"):
        withheld = {e.get("withheld") for e in condition["ranking"]}
        assert withheld == ({"reference noise"} if condition["dump"] == "short.spool" else {None})
    assert all("withheld" not in e for c in conditions(statistics, "mse") for e in c["ranking"])
    assert "No verdict on relMSE (reference noise): 4 results: record a longer reference, or compare mse." in text


def test_the_baseline_is_the_plans(good, run, tmp_path, dump):
    plan = f'recordings = ["{dump.name}"]\n' + PLAN
    statistics, text = evaluate(good, tmp_path, 'baseline = "uniform + gaussian"\n' + plan)
    assert statistics["baseline"] == "uniform + gaussian" and "ratio to uniform + gaussian" in text and "(baseline)" in text
    for condition in conditions(statistics, "relmse"):
        box, other = sorted(condition["ranking"], key=lambda e: e["filter"])
        assert "ratio" in box and "ratio" not in other and box["against_baseline"] == "worse"
    # The same the other way round, from the same results.
    good("evaluate", "--statistics-only", "out", "--baseline", "uniform + box")
    turned = json.loads((tmp_path / "out" / "statistics.json").read_text())
    for now, before in zip(conditions(turned, "relmse"), conditions(statistics, "relmse")):
        ratio = next(e["ratio"] for e in now["ranking"] if "ratio" in e)
        other = next(e["ratio"] for e in before["ranking"] if "ratio" in e)
        assert np.allclose(ratio, [1 / other[0], 1 / other[2], 1 / other[1]])
    (tmp_path / "wrong.toml").write_text('baseline = "uniform + gausian"\n' + plan)
    run("evaluate", "wrong.toml", "-o", "w").failed_with(2, "wrong.toml:1", "uniform + gaussian")
    run("evaluate", dump, "--spp", 2, "--baseline", "unifrm + box", "-o", "w").failed_with(2, "--baseline", "uniform + box")
    run("evaluate", "out.toml", "--baseline", "uniform + box", "-o", "w").failed_with(2, "--baseline", "the plan")


def test_errors_at_equal_time_are_read_between_the_budgets(good, tmp_path, dump):
    statistics, text = evaluate(good, tmp_path, f'recordings = ["{dump.name}"]\n' + PLAN.replace("[2, 4]", "[2, 4, 8]"), "out", "--wide")
    curve = next(c for c in statistics["curves"] if c["filter"] == "gaussian" and c["metric"] == "mse")
    own = {r["spp"]: (r["quantities"]["cpu_total"][0], r["quantities"]["mse"][0]) for r in statistics["results"] if r["filter"] == "gaussian"}
    base = {r["spp"]: (r["quantities"]["cpu_total"][0], r["quantities"]["mse"][0]) for r in statistics["results"] if r["filter"] == "box"}
    seconds, errors = zip(*sorted(own.values()))
    for at in curve["equal_time"]:
        assert np.isclose(at["seconds"], base[at["at"]][0])
        inside = seconds[0] <= at["seconds"] <= seconds[-1]
        assert ("ratio" in at) == inside
        if inside:
            expected = np.exp(np.interp(np.log(at["seconds"]), np.log(seconds), np.log(errors)))
            assert np.isclose(at["ratio"][0], expected / base[at["at"]][1], rtol=1e-6)
    assert len(curve["equal_time"]) == 3 and "In the processor time of the baseline" in text


def test_claims_are_registered_before_the_first_result(good, tmp_path, dump):
    plan = f'recordings = ["{dump.name}"]\n' + PLAN
    claim = '[[claim]]\ntext = "the blur helps"\nbetter = "uniform + gaussian"\nthan = "uniform + box"\n'
    statistics, text = evaluate(good, tmp_path, plan + claim)
    assert text.startswith("claim: the blur helps: holds\n") and statistics["claims"][0]["counts"] == {"holds": 2}
    later = '[[claim]]\ntext = "it halves MSE"\nbetter = "uniform + gaussian"\nthan = "uniform + box"\nmetric = "mse"\nbelow = 0.5\n'
    statistics, text = evaluate(good, tmp_path, plan + claim + later)
    assert ["after_results" in c for c in statistics["claims"]] == [False, True] and "(added after results)" in text
    shutil.rmtree(tmp_path / "out")
    statistics, text = evaluate(good, tmp_path, plan + claim + later)
    assert not any("after_results" in c for c in statistics["claims"])


def test_results_without_halves_say_that_the_spread_is_assumed(good, tmp_path, dump):
    statistics, text = evaluate(good, tmp_path, f'halves = false\nrecordings = ["{dump.name}"]\n' + PLAN)
    assert "assumed from common samples" in text
    statistics, text = evaluate(good, tmp_path, f'recordings = ["{dump.name}"]\n' + PLAN, "measured")
    assert "assumed" not in text


def test_a_claim_compares_times_over_threads(good, tmp_path):
    """Two threads against one, of the same method; of a machine that other results shared it says nothing."""
    made(tmp_path / "a.spool", 1)
    plan = 'recordings = ["a.spool"]\nspp = [4]\nreplicates = 4\nthreads = [1, 2]\npictures = false\nsamplers = ["uniform"]\nfilters = ["box"]\n'
    for below in (1.0, 0.6, 0.4):
        plan += ('[[claim]]\nbetter = "uniform + box"\nthan = "uniform + box"\nthreads = 2\nthan_threads = 1\nmetric = "seconds_sampling"\n'
                 f'below = {below}\ntext = "below {below}"\n')
    evaluate(good, tmp_path, plan, "out", "--timing", "exact")
    seconds = iter(range(10**6))

    def timed(timing):
        def change(cell):
            long = int(cell["fields"]["threads_used"]) == 1
            return {**cell, "fields": {**cell["fields"], "timing": timing, "seconds_sampling": str((2 if long else 1) * (1 + 1e-3 * (next(seconds) % 3)))}}
        return change
    changed_cells(tmp_path / "out", timed("alone"))
    good("evaluate", "--statistics-only", "out")
    claims = json.loads((tmp_path / "out" / "statistics.json").read_text())["claims"]
    assert [(c["threads"], c["verdict"], len(c["places"])) for c in claims] == [([2, 1], "holds", 1), ([2, 1], "holds", 1), ([2, 1], "reversed", 1)]
    assert claims[0]["places"][0]["threads"] == 2 and claims[0]["places"][0]["ratio"][0] == pytest.approx(0.5, rel=0.01)
    changed_cells(tmp_path / "out", timed("shared"))
    good("evaluate", "--statistics-only", "out")
    assert {c["verdict"] for c in json.loads((tmp_path / "out" / "statistics.json").read_text())["claims"]} == {"not compared"}
