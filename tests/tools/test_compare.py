"""`spool compare BEFORE AFTER`: what it claims, and its exit code."""
import json

import pytest

from conftest import samples, write_dump
from results_comparison import cell_lines, changed_cells, rows_of

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
    def changed(cell):
        if cells(cell):
            cell["fields"]["relmse"] = repr(float(cell["fields"]["relmse"]) * factor)
        return cell
    changed_cells(tmp_path / folder, changed)


def test_the_same_results_are_identical(good, evaluate):
    a, b = evaluate("a"), evaluate("b")
    out = good("compare", a, b, "--metric", "relmse,mse").out
    assert "12 comparisons (paired by replicate, on logarithms, all together)" in out and "12 identical" in out
    out = good("compare", a, b, "--metric", "relmse,cpu,energy_ratio", "--tolerance", 1000).out
    assert "18 comparisons (12 paired by replicate, 12 on logarithms, all together)" in out


def test_another_seed_is_not_told_apart(good, evaluate):
    found = good("compare", evaluate("a"), evaluate("b", seed=2), "--json").json
    assert {c["verdict"] for c in found["comparisons"]} == {"undecided"}
    assert not any(c["paired"] for c in found["comparisons"])


def test_why_replicates_of_one_image_are_not_compared_is_said(good, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")

    def one_image(cell):
        cell["fields"]["relmse"] = cell["fields"]["mse"] = "0.25"
        return cell
    changed_cells(tmp_path / "a", one_image)
    out = good("compare", a, b, "--all").out
    assert "6 not compared" in out and "replicates of one image, or an infinite error: 6" in " ".join(out.split())
    assert "[n/a" not in out and "replicates of one image" not in good("compare", b, b, "--all").out


def test_a_result_that_became_infinite_is_not_called_identical(good, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")
    firsts = {row["relmse"] for row in rows_of(tmp_path / "b") if row["replicate"] == "0"}
    change(tmp_path, "b", lambda cell: cell["fields"]["relmse"] in firsts, float("inf"))
    found = good("compare", a, b, "--json").json["comparisons"]
    assert {c["verdict"] for c in found} == {"not compared"}


def test_a_ratio_reads_one_only_where_it_is_one(run, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")
    change(tmp_path, "b", lambda cell: True, 1.00002)
    finished = run("compare", a, b)
    assert "6 worse" in finished.err and "1.00002 [1.00002, 1.00002]" in finished.out


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
        assert c["paired"] and c["low"] > 1 and c["after"] == pytest.approx(1.5 * c["before"])


def test_failures_and_gaps_are_told(run, good, evaluate, tmp_path):
    a = evaluate("a")
    evaluate("b")
    first = min(json.loads(line)["cell"] for line in cell_lines(tmp_path / "b"))
    changed_cells(tmp_path / "b", lambda cell: {**cell, "failed": 1, "fields": {"error": "broken on purpose"}} if cell["cell"] == first else cell)
    finished = run("compare", a, "b")
    assert finished.code == 1 and "failed now: scene" in finished.out
    evaluate("c", plan=PLAN.replace("[2, 4, 8]", "[2, 4]"))
    finished = run("compare", a, "c")
    assert finished.code == 1 and "only before" in finished.out
    assert "only after" in good("compare", "c", a).out


def test_what_fails_more_often_has_failed(run, evaluate, tmp_path):
    def fail(folder, count):
        numbers = sorted(json.loads(line)["cell"] for line in cell_lines(tmp_path / folder))[:count]
        changed_cells(tmp_path / folder, lambda cell: {**cell, "failed": 1, "fields": {"error": "broken on purpose"}} if cell["cell"] in numbers else cell)

    one = PLAN.replace("[2, 4, 8]", "[4]").replace('[[filter]]\nname = "gaussian"\n', "")
    a, b = evaluate("a", plan=one), evaluate("b", plan=one)
    fail("a", 1)
    fail("b", 6)
    assert run("compare", a, b, "--json").json["newly_failed"]
    run("compare", a, b).failed_with(1, "1 failed")
    evaluate("c", plan=PLAN.replace("[2, 4, 8]", "[4]"))
    fail("c", 12)
    finished = run("compare", evaluate("d", plan=one), "c")
    assert finished.code == 1 and "2 failed" in finished.err


def test_a_combination_with_fewer_replicates_is_incomplete(run, good, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")
    files = sorted((tmp_path / "b" / "cells").glob("*.jsonl"))
    lines = {file: file.read_text().splitlines(keepends=True) for file in files}
    for file, kept in lines.items():
        file.write_text("".join(line for line in kept if json.loads(line)["cell"] not in sorted(
            json.loads(line)["cell"] for line in cell_lines(tmp_path / "a"))[:5]))
    finished = run("compare", a, b)
    shown = [line.split() for line in finished.out.splitlines() if line.startswith("incomplete: b: scene  ")]
    assert finished.code == 1 and sum(int(words[-2]) - int(words[-4]) for words in shown) == 5
    assert f"{len(shown)} incomplete" in finished.err
    assert "incomplete: b: " in good("compare", b, a).out  # BEFORE may be
    warning = "warning: b: 5 of 36 results are missing: spool evaluate b/plan.toml -o b makes them"
    assert warning in good("evaluate", "--statistics-only", b).err
    good("evaluate", "b/plan.toml", "-o", "b")
    assert "incomplete" not in good("compare", a, b).out and "missing" not in good("evaluate", "--statistics-only", b).err


def test_what_was_judged_differently_is_not_compared(run, good, evaluate):
    ways = {"own": "independent", "pool": "pool (biased)", "held": "holdout, 4 held out", "more": "holdout, 5 held out",
            "eps": "independent, rel_eps=0.1", "clamped": "holdout, 4 held out, firefly_limit=3"}
    plan = PLAN.replace("[2, 4, 8]", "[2]")
    own = evaluate("own", plan=plan)
    evaluate("pool", plan='reference = "pool"\n' + plan)
    evaluate("held", plan='reference = "holdout"\nholdout = 4\n' + plan)
    evaluate("more", plan='reference = "holdout"\nholdout = 5\n' + plan)
    evaluate("eps", plan=plan + "[metrics]\nrel_eps = 0.1\n")
    evaluate("clamped", plan='reference = "holdout"\nholdout = 4\n' + plan + "[pool]\nfirefly_limit = 3\n")
    for before, after in [("pool", own), (own, "pool"), (own, "held"), ("held", "more"), (own, "eps"), ("held", "clamped")]:
        finished = run("compare", before, after, "--all")
        finished.failed_with(1, "2 judged differently")
        text = " ".join(finished.out.split())
        assert f"Judged differently, not compared: 2: by {ways[before]} before, {ways[after]} after." in text
        assert "2 not compared" in text and ("BIASED" in text) == ("pool" in (before, after))
    assert run("compare", own, "pool", "--json").json["comparisons"][0]["verdict"] == "not compared"
    evaluate("named", plan='reference = "independent"\n' + plan + '[metrics]\nperceptual = "none"\n')
    assert "2 identical" in good("compare", own, "named").out
    times = good("compare", own, "pool", "--metric", "cpu", "--tolerance", 100)  # times are not judged
    assert "of one run each" in " ".join(times.out.split()) and "one run" not in good("compare", own, own).out


def test_another_picture_of_the_same_file_name_is_not_compared(run, good, tmp_path):
    def results(folder, scene, size=32, seed=1):
        (tmp_path / folder).mkdir()
        good("synth", scene, "--size", size, "--samples", 16, "--seed", seed, "-o", f"{folder}/s.spool")
        good("evaluate", f"{folder}/s.spool", "--samplers", "uniform", "--filters", "box", "--spp", 4, "--no-pictures", "-o", f"r{folder}")
        return f"r{folder}"

    own = results("own", "scene_s")
    for other, why in [(results("size", "scene_s", 20), "32 x 32 pixels before, 20 x 20 pixels after"),
                       (results("scene", "fireflies"), "of scene_s before, fireflies after")]:
        for metric in ("relmse", "cpu"):
            finished = run("compare", own, other, "--metric", metric)
            finished.failed_with(1, "0 worse", "1 judged differently")
            assert f"Judged differently, not compared: 1: by another recording: {why}." in " ".join(finished.out.split())
    (tmp_path / "scene" / "s.spool").unlink()  # the results alone tell the references apart
    assert "reference of mean luminance 0.5" in run("compare", own, "rscene").out
    again = good("compare", own, results("again", "scene_s", seed=2), "--json").json["comparisons"]
    assert [(c["paired"], c["verdict"]) for c in again] == [(False, "undecided")]


def test_claims_of_one_text_stay_two(good, evaluate):
    claim = '[[claim]]\ntext = "x"\nmetric = "mse"\nspp = [8]\nbetter = "uniform + {}"\nthan = "uniform + {}"\n'
    a = evaluate("a", plan=PLAN.replace("{seed}", "1") + claim.format("gaussian", "box") + claim.format("box", "gaussian"))
    claims = [line for line in good("compare", a, a).out.splitlines() if line.startswith("claim")]
    assert len(claims) == 2 and claims[0] != claims[1]


def test_times_are_compared_by_name_only(run, evaluate):
    a = evaluate("a")
    assert {c["metric"] for c in run("compare", a, a, "--json").json["comparisons"]} == {"relmse"}
    found = run("compare", a, a, "--json", "--metric", "cpu").json["comparisons"]
    assert {c["metric"] for c in found} == {"cpu"} and {c["verdict"] for c in found} == {"identical"}


def test_damaged_cells_are_told_and_make_no_answer_by_themselves(run, good, evaluate, tmp_path):
    a, b = evaluate("a"), evaluate("b")
    cells = next((tmp_path / "b/cells").glob("*.jsonl"))
    lines = cells.read_text().splitlines(keepends=True)
    cells.write_text("".join([lines[0].replace("0", "1", 1), *lines[1:]]))
    for words in (("compare", a, b), ("evaluate", "--statistics-only", b), ("report", b, "-o", "b.html")):
        assert "warning: 1 damaged results count as missing; the first: b/cells/" in run(*words).err, words
    cells.write_text("".join("junk\n" for _ in lines))
    for words in (("compare", a, b), ("evaluate", "--statistics-only", b)):
        run(*words).failed_with(1, f"b: no finished results in it; {len(lines)} damaged results count as missing; the first: b/cells/")


def test_what_has_no_results_is_not_merged_into_a_new_folder(run, evaluate, tmp_path):
    evaluate("a")
    (tmp_path / "empty").mkdir()
    for name in ("empty", "none"):
        run("evaluate", "a.toml", "--merge", "--from", name, "-o", "new").failed_with(3, f"{name}: has no folder cells")
    assert not (tmp_path / "new").exists()


def test_a_file_of_counts_that_asks_for_fewer_is_no_recording_that_ran_out(good, dump):
    good("replay", dump, "--sampler", "uniform", "--spp", 2, "-o", "n.exr")
    done = good("evaluate", dump, "--samplers", "uniform,counts:n.exr", "--spp", 4, "--replicates", 2, "-o", "out")
    assert "2 of 4 results spent less than their budget because their file of counts asks for fewer" in done.err
    assert "ran out" not in done.err


def test_wrong_use(run, evaluate, tmp_path):
    a = evaluate("a")
    run("compare", a, "none").failed_with(3, "plan.toml")
    run("compare", a, a, "--metric", "relmze").failed_with(2, "did you mean 'relmse'")
    run("compare", a, a, "--metric", "relmse,mse,relmse").failed_with(2, "--metric relmse: is asked for twice: name it once")
    write_dump(tmp_path / "third.spool", samples(seed=9)[0])
    evaluate("d", plan=PLAN.replace("scene.spool", "third.spool"))
    run("compare", a, "d").failed_with(1, "no result in common", "third  ", "scene  ", "must be alike", "--match name")


def test_statistics_have_ranks_pairs_slopes_and_samples(evaluate, tmp_path):
    (tmp_path / "scene.spool").unlink()
    radiance, reference = samples(height=64, width=64)
    write_dump(tmp_path / "scene.spool", radiance, reference=reference[..., None].repeat(3, axis=2).astype("<f4"))
    evaluate("a")
    found = json.loads((tmp_path / "a" / "statistics.json").read_text())
    at_8 = next(c for c in found["conditions"] if c["spp"] == 8 and c["metric"] == "mse")
    assert [r["letters"] for r in at_8["ranking"]] == ["a", "b"] and not at_8["biased"]
    assert at_8["about"]["kind"] == "shared" and 0 < at_8["about"]["shared"] < 1
    better, box = at_8["ranking"]
    assert better["against_baseline"] == "better" and "against_baseline" not in box
    assert 0 < better["ratio"][1] <= better["ratio"][0] <= better["ratio"][2] < 1
    assert better["ratio"][0] == pytest.approx(better["value"][0] / box["value"][0])
    (a, b, ratio, low, high, p, verdict), = at_8["pairs"]
    assert (a, b, verdict) == (0, 1, "better") and p < 0.05 and [ratio, low, high] == better["ratio"]
    box = next(c for c in found["curves"] if c["filter"] == "box" and c["metric"] == "mse")
    slope, low, high = box["slope"]
    assert -1.3 < slope < -0.7 and low < slope < high
    gaussian = next(c for c in found["curves"] if c["filter"] == "gaussian" and c["metric"] == "mse")
    needed = gaussian["needed"]
    assert [n["at"] for n in needed] == [2, 4, 8]
    assert all(n["low"] <= n["spp"] <= n["high"] for n in needed)


def test_a_change_of_an_option_is_compared_by_name(run, good, evaluate):
    plan = PLAN.replace('name = "gaussian"', 'name = "gaussian"\nsigma = {seed}')
    a, b = evaluate("a", 1, plan), evaluate("b", 2, plan)
    finished = run("compare", a, b)
    assert finished.code == 1 and "only before: scene  uniform + gaussian{sigma=1}" in finished.out
    found = run("compare", a, b, "--match", "name", "--json", "--all").json
    assert found["only_before"] == found["only_after"] == []
    changed = [c["combination"] for c in found["comparisons"] if "->" in c["combination"]]
    assert len(changed) == 3 and all("sigma=1" in c and "sigma=2" in c for c in changed)
    evaluate("c", 1, plan.replace("sigma = {seed}", "sigma = [1, 2]"))
    run("compare", a, "c", "--match", "name").failed_with(2, "have one name")


def test_a_label_matches_whatever_it_stands_for_and_the_help_says_so(good, dump):
    for folder, method in (("a", "ours=multiscale{alpha=0.3}"), ("b", "ours=greedy_error")):
        good("evaluate", dump, "--samplers", method, "--filters", "box", "--spp", 4, "--replicates", 4, "--no-pictures", "-o", folder)
    assert "1 comparison " in good("compare", "a", "b", "--tolerance", 100).out
    assert "by their own label or with their options; name: whatever their labels and options" in " ".join(good("compare", "--help").out.split())


def test_presets_of_one_method_are_compared_by_name(run, good, dump, tmp_path):
    for preset in ("paper", "robust"):
        good("evaluate", dump, "--samplers", f"multiscale:{preset}", "--spp", 4, "--replicates", 4, "--no-pictures", "-o", preset)
    assert run("compare", "paper", "robust").code == 1  # by label they have nothing in common
    found = run("compare", "paper", "robust", "--match", "name", "--json", "--all").json
    assert found["comparisons"] and all("multiscale:paper" in c["combination"] and "->" in c["combination"] for c in found["comparisons"])
    # A folder with both is matched by preset.
    good("evaluate", dump, "--samplers", "multiscale:paper,multiscale:robust", "--spp", 4, "--replicates", 4, "--no-pictures", "-o", "both")
    found = run("compare", "both", "robust", "--match", "name", "--json", "--all").json
    assert {c["verdict"] for c in found["comparisons"]} <= {"identical", "undecided", "not compared"}
    assert len(found["only_before"]) == 1 and "paper" in found["only_before"][0]


def test_statistics_of_an_old_folder_are_computed_anew(run, good, evaluate, tmp_path):
    a = evaluate("a")
    path = tmp_path / a / "statistics.json"
    before = path.read_text()
    path.unlink()
    table = good("evaluate", "--statistics-only", a).out
    # Recordings are named as plan.toml does it, by their whole paths.
    whole = before.replace('"scene.spool"', json.dumps(str(tmp_path / "scene.spool")))
    assert path.read_text() == whole and "gaussian" in table
    # A folder of an older program: own orders, no counts, no size of the recording.
    plan = tmp_path / a / "plan.toml"
    changed_cells(tmp_path / a, lambda cell: {**{k: v for k, v in cell.items() if k != "counts"},
                                              "fields": {k: v for k, v in cell["fields"].items() if k != "recorded_spp"}})
    good("evaluate", "--statistics-only", a)
    known = json.loads(path.read_text())["conditions"][-1]["about"]
    assert known["kind"] == "shared"  # the size is read from the recording
    (tmp_path / "scene.spool").unlink()
    good("evaluate", "--statistics-only", a)
    assert json.loads(path.read_text())["conditions"][-1]["about"]["kind"] == "order"
    run("evaluate", "--statistics-only", "none").failed_with(3, "plan.toml")
    for option in ("--spp=4", "--fresh", "--output=new"):
        run("evaluate", "--statistics-only", a, option).failed_with(2, option.split("=")[0][:2], "leave it out")
    assert plan.exists()


def test_recordings_of_one_scene_count_together(good, dump, tmp_path):
    radiance, mean = samples(seed=5)
    reference = mean[:, :, None].repeat(3, axis=2).astype("<f4")
    write_dump(tmp_path / "again.spool", radiance, reference=reference, reference_variance=0 * reference)
    (tmp_path / "p.toml").write_text(PLAN.format(seed=1).replace('recordings = ["scene.spool"]', "") + """
[[dump]]
file = "scene.spool"
group = "one"
[[dump]]
file = "again.spool"
group = "one"
""")
    good("evaluate", "p.toml", "-o", "p")
    found = json.loads((tmp_path / "p" / "statistics.json").read_text())
    assert [len(s["recordings"]) for s in found["scenes"]] == [2]
    assert {r["replicates"] for r in found["results"]} == {12}
    assert [c["spp"] for c in found["conditions"] if c["metric"] == "mse"] == [2, 4, 8]


def test_recordings_of_a_group_must_be_alike(run, dump, tmp_path):
    radiance, mean = samples(seed=5)
    reference = mean[:, :, None].repeat(3, axis=2).astype("<f4")
    plan = PLAN.format(seed=1).replace('recordings = ["scene.spool"]', "") + "".join(
        f'\n[[dump]]\nfile = "{name}.spool"\ngroup = "one"\n' for name in ("scene", "other"))
    (tmp_path / "p.toml").write_text(plan)
    other = tmp_path / "other.spool"
    for cut, judge in [(radiance[:, :-1], reference[:, :-1]), (radiance[:, :, :-1], reference), (radiance, None)]:
        other.unlink(missing_ok=True)
        write_dump(other, cut, **({} if judge is None else {"reference": judge, "reference_variance": 0 * judge}))
        for options in (["-o", "p"], ["--dry-run"]):
            run("evaluate", "p.toml", *options).failed_with(1, "other.spool", "group", "of its own")
    other.write_bytes(dump.read_bytes())
    for options in (["-o", "p"], ["--dry-run"]):
        for what in (["p.toml"], ["scene.spool", "other.spool", "--spp", "4"]):
            run("evaluate", *what, *options).failed_with(2, "scene.spool", "other.spool", "are one recording")
    other.unlink()
    write_dump(other, radiance)
    (tmp_path / "p.toml").write_text('reference = "holdout"\nholdout = 4\n' + plan)
    assert run("evaluate", "p.toml", "-o", "p").code == 0  # judged by a part of each


def test_ranks_among_methods_that_keep_the_energy(good, dump, tmp_path):
    (tmp_path / "p.toml").write_text("energy_band = [2, 3]\n" + PLAN.format(seed=1))
    good("evaluate", "p.toml", "-o", "p")
    found = json.loads((tmp_path / "p" / "statistics.json").read_text())
    assert not any(e["compared"] or e["letters"] for c in found["conditions"] for e in c["ranking"])


def test_a_biased_reference_is_marked_everywhere(good, run, dump, tmp_path):
    good("evaluate", dump, "--spp", "2,4", "--reference", "pool", "-o", "p", "--no-pictures")
    assert "BIASED" in good("compare", "p", "p").out
    assert all(c["biased"] for c in run("compare", "p", "p", "--json").json["comparisons"])
    statistics = json.loads((tmp_path / "p" / "statistics.json").read_text())
    assert all(c["biased"] for c in statistics["conditions"] + statistics["curves"])
    assert "pool (biased)" in (tmp_path / "p" / "results.csv").read_text()
    assert '"pool (biased)"' in (tmp_path / "p" / "results.jsonl").read_text().splitlines()[0]
