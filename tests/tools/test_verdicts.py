"""What a verdict may stand on, and what is printed of it: withheld verdicts, groups, baselines, claims, equal time."""
import json
import shutil

import numpy as np
import pytest
import spool
from spool import exr

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
    assert all(len(r["quantities"][metric]) == 1 for r in results for metric in ("mse_r", "rmse"))
    assert "No verdict on MSE (few pixels)" in text and "three times" in text and "Few pixels: " in text
    group = "\n".join(f'[[dump]]\nfile = "lamp{n}.spool"\ngroup = "lamp"' for n in range(3))
    statistics, text = evaluate(good, tmp_path, PLAN + group, "group")
    for condition in conditions(statistics, "mse"):
        assert condition["about"]["kind"] == "recordings" and "spread between these" in condition["about"]["text"]
        assert all("withheld" not in e and len(e["value"]) == 3 for e in condition["ranking"])
    # Of the third nothing is there yet.
    partial = tmp_path / "partial"
    partial.mkdir()
    shutil.copy(tmp_path / "group" / "plan.toml", partial)
    lines = (tmp_path / "group" / "results.jsonl").read_text().splitlines(keepends=True)
    (partial / "kept.jsonl").write_text("".join(line for line in lines if json.loads(line)["dump"] != "lamp2"))
    good("evaluate", "--statistics-only", partial)
    for condition in conditions(json.loads((partial / "statistics.json").read_text()), "mse"):
        assert "2 were given" in condition["about"]["text"] and "spread between these" not in condition["about"]["text"]
    # Student's interval of three numbers, the means of the recordings' logarithms.
    rows = [json.loads(line) for line in (tmp_path / "group" / "results.jsonl").read_text().splitlines()]
    for result in statistics["results"]:
        logs = [np.log([r["mse"] for r in rows if (r["dump"], r["filter"], r["spp"]) == (f"lamp{n}", result["filter"], result["spp"])])
                for n in range(3)]
        means = np.mean(logs, axis=1)
        mean, low, high = np.log(result["quantities"]["mse"])
        assert np.isclose(mean, means.mean())
        assert np.isclose((high - low) / 2, 4.30265273 * means.std(ddof=1) / np.sqrt(3), rtol=1e-6)


def test_errors_of_few_pixels_are_as_alike_as_their_samples(good, tmp_path):
    """Replicates that share half of their samples have or have not what makes the error of one pixel: the square of that half is too little."""
    random, reference = np.random.default_rng(0), np.ones((32, 32))
    radiance = random.gamma(2, 0.5, (32, 32, 32))
    radiance[5, 5], reference[5, 5] = random.gamma(0.5, 100, 32), 50
    radiance, reference = (np.repeat(image[..., None], 3, axis=-1).astype("<f4") for image in (radiance, reference))
    write_dump(tmp_path / "r.spool", radiance, reference=reference, reference_variance=0 * reference)
    statistics, _ = evaluate(good, tmp_path, 'recordings = ["r.spool"]\nspp = [16]\nreplicates = 16\npictures = false\nsamplers = ["uniform"]\nfilters = ["box"]\n')
    result = statistics["results"][0]
    logs = np.log([json.loads(line)["mse"] for line in (tmp_path / "out" / "results.jsonl").read_text().splitlines()])
    share, n, (_, low, high) = result["shared"], len(logs), np.log(result["quantities"]["mse"])
    assert share > 0.4 and result["quantities"]["mse_half_pixels"][0] < 3
    assert (high - low) / 2 > 1.96 * logs.std(ddof=1) * np.sqrt((1 + (n - 1) * share) / (1 - share) / n)


def test_what_is_trimmed_of_an_error_of_few_pixels_has_no_verdict(good, tmp_path):
    """One pixel is bright where its reference is dark; without it the error stands on the pixels that the next recording has instead."""
    radiance, mean = samples(seed=1)
    radiance[5, 5] += np.float32(100) * radiance[5, 5]
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    write_dump(tmp_path / "dark.spool", radiance, reference=reference, reference_variance=0 * reference)
    plan = 'recordings = ["dark.spool"]\n' + PLAN.replace("replicates = 4", "replicates = 2")
    statistics, text = evaluate(good, tmp_path, plan, "out", "--wide")
    box = [r["quantities"] for r in statistics["results"] if r["filter"] == "box"]
    for metric in ("relmse", "relmse_trimmed", "relmse_g", "relmse_plain", "smape"):
        assert {len(quantities[metric]) for quantities in box} == {3 if metric == "smape" else 1}, metric
    for metric in ("relmse", "relmse_trimmed"):
        entries = [e for c in conditions(statistics, metric) for e in c["ranking"] if e["filter"] == "box"]
        assert len(entries) == 2 and all(e["withheld"] == "few pixels" and len(e["value"]) == 1 and not e["compared"] for e in entries), metric
    assert all("withheld" not in e for c in conditions(statistics, "smape") for e in c["ranking"])
    assert "No verdict on relMSE (few pixels)" in text and "record the scene three times or more.\n" in text


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


def test_the_baseline_is_the_method_of_that_name_and_not_the_first_like_it(good, tmp_path, dump):
    evaluated = ("evaluate", dump, "--spp", 4, "--no-pictures", "-o", "out", "--force")
    for filters, baseline in (("box{clamp=on},box,gaussian", "uniform + box"), ("box{clamp=on},gaussian", "uniform + box{clamp=on}")):
        text = good(*evaluated, "--filters", filters).out
        lines = [line.split("  ")[1] for line in text.splitlines() if line.endswith("(baseline)")]
        assert lines == [baseline] and f"ratio to {baseline} at" in text
        statistics = json.loads((tmp_path / "out" / "statistics.json").read_text())
        assert statistics["baseline"] == baseline
        alone = [f"{e['sampler']} + {e['filter']}" for c in conditions(statistics, "mse") for e in c["ranking"] if "against_baseline" not in e]
        assert alone == [baseline]
    text = good(*evaluated, "--filters", "box", "--samplers", "ref=uniform,multiscale").out
    assert "ratio to ref + box at" in text and text.count("(baseline)") == 1
    text = good(*evaluated, "--filters", "box{clamp=on},box{energy=box}").out
    assert "no ratio without a baseline" in text and "(baseline)" not in text
    text = good(*evaluated, "--filters", "box", "--samplers", "uniform,mitchell", "--baseline", "mitchell + box").out
    assert "ratio to mitchell + box at" in text and text.count("(baseline)") == 1


def test_energy_is_the_mean_of_the_images(good, tmp_path):
    """One of 16 samples is bright: each of eight replicates has it or has it not, and no light is lost."""
    made(tmp_path / "lamp.spool", 1, 1e4)
    statistics, text = evaluate(good, tmp_path, 'recordings = ["lamp.spool"]\n' + PLAN.replace("[2, 4]", "[2]").replace("replicates = 4", "replicates = 8"))
    rows = [json.loads(line) for line in (tmp_path / "out" / "results.jsonl").read_text().splitlines()]
    box = next(r for r in statistics["results"] if r["filter"] == "box")
    mean, low, high = box["quantities"]["energy_ratio"]
    energies = [r["energy_ratio"] for r in rows if r["filter"] == "box"]
    assert mean == pytest.approx(np.mean(energies)) == pytest.approx(1, abs=0.1)
    assert np.exp(np.mean(np.log(energies))) < 0.8 and high - mean == pytest.approx(mean - low)
    assert "Light is lost" not in text and not [e for c in statistics["conditions"] for e in c["ranking"] if "loses_energy" in e]


def test_light_that_is_lost_or_gained_is_named_with_the_largest_first(good, tmp_path):
    made(tmp_path / "a.spool", 1)
    with spool.open(tmp_path / "a.spool") as dump:
        reference = dump.pixel("reference")
    images = {"dark": 0.5, "equal": 1.001, "bright": 1.5, "brighter": 2}
    for name, factor in images.items():
        exr.write(tmp_path / f"{name}.exr", {c: factor * reference[..., i] for i, c in enumerate("RGB")})
    text = good("evaluate", "a.spool", "--filters", ",".join(f"{name}=image:{name}.exr" for name in images), "--spp", 4, "-o", "out").out
    assert "Light is lost by more than 2 % beyond the interval: uniform + dark (up to 50.0 %).\n" in text
    assert "Light is gained by more than 2 % beyond the interval: uniform + brighter (up to 100.0 %), uniform + bright (up to 50.0 %).\n" in text


def test_energies_have_a_mean_over_scenes(good, tmp_path):
    for name, seed in (("a", 1), ("b", 2)):
        made(tmp_path / f"{name}.spool", seed)
    statistics, _ = evaluate(good, tmp_path, 'recordings = ["a.spool", "b.spool"]\n' + PLAN)
    for overall in statistics["overall"]:
        alone = [r["quantities"]["energy_ratio"][0] for r in statistics["results"] if (r["filter"], r["spp"]) == (overall["filter"], overall["spp"])]
        assert overall["quantities"]["energy_ratio"][0] == pytest.approx(np.mean(alone), rel=1e-12)


def test_fresh_samples_of_crossfit_are_widened_by_what_replicates_share(good, tmp_path, dump):
    """A fresh image takes `spp` of a quarter of the 16 samples: halves of two, all of four."""
    claim = '[[claim]]\ntext = "blur"\nbetter = "uniform + gaussian"\nthan = "uniform + box"\nmetric = "mse"\nsamples = "fresh"\n'
    plan = f'recordings = ["{dump.name}"]\nreference = "crossfit"\nfresh = true\n' + PLAN.replace("replicates = 4", "replicates = 8") + claim
    statistics, _ = evaluate(good, tmp_path, plan)
    half, whole = statistics["claims"][0]["places"]
    rows = [json.loads(line) for line in (tmp_path / "out" / "results.jsonl").read_text().splitlines()]
    logs = {f: np.log([r["mse_fresh"] for r in rows if (r["filter"], r["spp"]) == (f, 2)]) for f in ("box", "gaussian")}
    student = 2.36462425 * np.std(logs["gaussian"] - logs["box"], ddof=1) / np.sqrt(8)
    mean, low, high = np.log(half["ratio"])
    assert high - mean > 1.5 * student
    assert whole["verdict"] == "undecided" and len(whole["ratio"]) == 1


def test_a_claim_says_why_it_is_not_compared_and_what_favours_a_method(good, tmp_path, dump, lamps):
    claim = '[[claim]]\ntext = "blur"\nbetter = "uniform + gaussian"\nthan = "uniform + box"\nmetric = "mse"\n'
    _, text = evaluate(good, tmp_path, 'halves = false\nrecordings = ["lamp0.spool"]\n' + PLAN + claim)
    assert "lamp0 2 spp: not compared (few pixels)" in text
    for name, reference in (("pool", 'reference = "pool"\n'), ("independent", "")):
        statistics, _ = evaluate(good, tmp_path, reference + f'recordings = ["{dump.name}"]\n' + PLAN + claim, name)
        assert {p["biased"] for p in statistics["claims"][0]["places"]} == {name == "pool"}


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


def test_a_claim_about_errors_counts_once_whatever_the_threads(good, tmp_path):
    good("synth", "scene_s", "--size", 24, "--samples", 8, "-o", "a.spool")
    plan = 'recordings = ["a.spool"]\nspp = [4]\nreplicates = 4\nthreads = {}\npictures = false\nsamplers = ["uniform"]\nfilters = ["box", "gaussian"]\n'
    for metric in ("mse", "seconds_filtering"):
        plan += f'[[claim]]\nbetter = "uniform + gaussian"\nthan = "uniform + box"\ntext = "{metric}"\nmetric = "{metric}"\n'
    found, said = {}, {}
    for threads in ("[1, 2]", "[1]"):
        (tmp_path / "p.toml").write_text(plan.format(threads))
        said[threads] = good("evaluate", "p.toml", "-o", "r" + threads).out
        claims = json.loads((tmp_path / ("r" + threads) / "statistics.json").read_text())["claims"]
        found[threads] = [[{k: v for k, v in place.items() if k != "p"} for place in claim["places"]] for claim in claims]
    errors, times = found["[1, 2]"]
    assert errors == found["[1]"][0] and len(errors) == 1
    assert [place["threads"] for place in times] == [1, 2]
    assert "a 4 spp: " in said["[1, 2]"] and "a 4 spp, 1 thread: " in said["[1, 2]"] and "a 4 spp, 2 threads: " in said["[1, 2]"]
    good("figure", "r[1, 2]", "-o", "f")
    assert "- a, 4 spp, 2 threads: " in (tmp_path / "f/table.md").read_text()
    good("report", "r[1, 2]", "-o", "r.html")
    assert "a, 2 threads</th>" in (tmp_path / "r.html").read_text()


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
