"""`spool evaluate`: its table, its numbers against numpy, its pictures, its errors."""
import fcntl
import json
import math
import os
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from spool import exr

from conftest import LONGEST_RUN, PROGRAM, read_exr, samples, write_dump
from results_comparison import assert_same_results, cell_lines, rows_of


def test_every_cell_is_a_row_and_columns_are_the_listed_ones(good, dump, tmp_path):
    good("evaluate", dump, "--filters", "box,gaussian", "--spp", "2,4", "--replicates", 3, "-o", "out")
    rows = rows_of(tmp_path / "out")
    assert len(rows) == 2 * 2 * 3
    assert list(rows[0]) == [column["name"] for column in good("list", "columns", "--json").json]
    cells = {(r["filter"], r["spp"], r["replicate"]) for r in rows}
    assert cells == {(f, s, r) for f in ("box", "gaussian") for s in "24" for r in "012"}


def test_mse_in_recorded_order_is_that_of_numpy(good, dump, tmp_path):
    radiance, mean = samples()
    good("evaluate", dump, "--spp", 4, "--recorded-order", "--replicates", 1, "-o", "out")
    estimate = radiance[:, :, :4].astype(float).mean(axis=2)
    expected = ((estimate - mean[:, :, None].astype("<f4")) ** 2).mean()
    row = rows_of(tmp_path / "out")[0]
    assert np.isclose(float(row["mse"]), expected, rtol=1e-6)
    assert np.isclose(float(row["recorded_kurtosis"]), kurtosis_of(radiance))
    assert row["error"] == "" and int(row["samples_spent"]) == 4 * mean.size


def test_recorded_order_is_one_replicate(good, run, dump, tmp_path):
    """Seven of eight replicates failed after all work was done, and a dry run listed them."""
    plan = tmp_path / "plan.toml"
    plan.write_text('recordings = ["scene.spool"]\nspp = [4]\norder = "recorded"\nsamplers = ["uniform"]\nfilters = ["box"]\n')
    for words in ([dump, "--spp", 4, "--recorded-order"], [plan]):
        assert "1 replicate x" in good("evaluate", *words, "--dry-run").out
        good("evaluate", *words, "-o", "out", "--no-pictures")
        assert [row["replicate"] for row in rows_of(tmp_path / "out")] == ["0"]
    plan.write_text(plan.read_text() + "replicates = 2\n")
    for words in ([dump, "--spp", 4, "--recorded-order", "--replicates", 2], [plan]):
        for more in (["--dry-run"], ["-o", "none"]):
            run("evaluate", *words, *more).failed_with(2, "recorded order: 2 replicates would be of the same samples", "--replicates 1")
    assert not (tmp_path / "none").exists()


def kurtosis_of(radiance):
    """Of samples [y][x][s][c]: fourth cumulant over squared variance, weighted as in relMSE (Fisher's k-statistics)."""
    values = radiance.astype(float).mean(axis=-1).reshape(-1, radiance.shape[2])
    n, means = values.shape[-1], values.mean(axis=-1)
    m2, m4 = (((values - means[:, None]) ** k).mean(axis=-1) for k in (2, 4))
    k2 = m2 * n / (n - 1)
    k4 = n * n * ((n + 1) * m4 - 3 * (n - 1) * m2**2) / ((n - 1) * (n - 2) * (n - 3))
    weight = 1 / (means**2 + 0.01 * means.mean() ** 2) ** 2
    return (weight * k4).sum() / (weight * (k2**2 - k4 / n) * (n - 1) / (n + 1)).sum()


def spread_of_halves(folder, metric):
    """Variance between recordings of the logarithm of a metric of uniform + box, and its degrees of freedom, from the halves
    that the folder keeps: cells summed in windows of 2 x 2, freedom by the kurtosis of the cells."""
    rows = {(row["sampler"], row["filter"], row["replicate"]): row for row in rows_of(folder)}
    splits = []
    for cell in map(json.loads, sorted(cell_lines(folder))):
        wanted = [rows["uniform", "box", r]["mse"] for r in ("0", "1")]
        if "halves" in cell and cell["fields"]["mse"] in wanted:
            kept = cell["halves"][metric]
            splits.append(np.array(kept["cells"].split(), float).reshape(-1, kept["columns"]))
    assert len(splits) == 2
    windows = [sum(np.pad(s, 1)[y:y + s.shape[0] + 1, x:x + s.shape[1] + 1] for y in (0, 1) for x in (0, 1)) for s in splits]
    variance = np.mean([(w ** 2).sum() / 8 for w in windows])
    squares = np.mean([s ** 2 for s in splits], axis=0)
    return variance, max(1.0, (2 * squares.sum() ** 2 / (squares ** 2).sum() - 1) / 2.25)


def student_within(reach, freedom):
    """P(|T| <= reach) of Student's distribution, by the trapezoid rule."""
    t = np.linspace(-reach, reach, 20001)
    density = math.gamma((freedom + 1) / 2) / math.gamma(freedom / 2) / math.sqrt(freedom * math.pi) * (1 + t * t / freedom) ** (-(freedom + 1) / 2)
    return ((density[1:] + density[:-1]) / 2).sum() * (t[1] - t[0])


def test_table_has_ratios_to_uniform_with_box(good, dump, tmp_path):
    result = good("evaluate", dump, "--filters", "box,gaussian", "--spp", 4, "-o", "out", "--json").json
    by_filter = {entry["filter"]: entry for entry in result["results"]}
    mean, low, high = by_filter["box"]["quantities"]["mse"]
    ratio = by_filter["gaussian"]["ranks"]["mse"]["ratio"]
    assert np.isclose(ratio[0], by_filter["gaussian"]["quantities"]["mse"][0] / mean)
    logs = np.log([float(r["mse"]) for r in rows_of(tmp_path / "out") if r["filter"] == "box"])
    assert len(logs) == 8 and np.isclose(np.log(mean), np.mean(logs))
    # On a ring of 16 samples, of every eight replicates of 4 two share a half with each.
    assert np.isclose(by_filter["box"]["shared"], 1 / 7)
    kurtosis = kurtosis_of(samples()[0])
    rare = max(kurtosis, 0) / 4 / (2 + max(kurtosis, 0) / 4)
    alike = rare / 7 + (1 - rare) / 14
    assert np.isclose(by_filter["box"]["correlation"], alike)
    variance, freedom = spread_of_halves(tmp_path / "out", "mse")
    all_freedom = freedom + 7 * (1 - alike)
    of_one = (freedom * variance + 7 * np.var(logs, ddof=1)) / all_freedom
    if (of_replicates := np.var(logs, ddof=1) / (1 - alike)) > of_one:
        of_one, all_freedom = of_replicates, min(all_freedom, 7)
    reach = np.log(high / mean) / np.sqrt(of_one * (1 + 7 * alike) / 8)
    assert np.isclose(np.log(mean / low), np.log(high / mean))
    assert abs(student_within(reach, all_freedom) - 0.95) < 1e-3
    text = good("evaluate", dump, "--spp", 4, "-o", "text", "--wide").out
    assert f"{mean:.4g} [" in text and "results.csv" in text and "share up to 14 %" in text
    text = good("evaluate", dump, "--spp", 16, "-o", "whole").out
    assert "share up to 100 %" in text


def test_one_pixel_is_no_plural(good):
    good("synth", "scene_s", "--size", "1x1", "--samples", 16, "-o", "one.spool")
    text = good("evaluate", "one.spool", "--spp", "1,2", "-o", "one").out
    assert "Few pixels: 1 pixel bears half of" in text and "one, 1 sample per pixel\n" in text


def test_replicates_of_one_image_are_not_called_one_replicate(good):
    good("synth", "black", "--size", 8, "--samples", 16, "-o", "black.spool")
    assert "About these images: one replicate, or replicates that are one image" in good("evaluate", "black.spool", "--spp", 2, "-o", "black").out


def bytes_of(folder, suffix):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob(f"*{suffix}")) if path.is_file()}


def test_images_are_kept_and_pictures_drawn_when_asked_for(good, run, dump, tmp_path):
    words = ("evaluate", dump, "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", 4, "--replicates", 2)
    assert "of each result: spool picture out" in good(*words, "-o", "out").out
    out = tmp_path / "out"
    assert set(bytes_of(out, ".png")) == {"scene_4spp.png"}
    kept = bytes_of(out, ".exr")
    numbers = {"estimate.exr", "density.exr", "squared_error.exr", "flip.exr", "filter_size.exr", "direction.exr"}
    assert {path.name for path in (out / "scene_multiscale_directional_4spp").iterdir()} == numbers
    assert (read_exr(out / "scene_uniform_box_4spp" / "density.exr", "n") == 4).all()
    row, = (r for r in rows_of(out) if (r["sampler"], r["filter"], r["replicate"]) == ("uniform", "box", "0"))
    assert np.isclose(read_exr(out / "scene_uniform_box_4spp" / "flip.exr", "flip").mean(), float(row["flip_ldr"]), rtol=1e-6)
    assert "4 results" in good("picture", "out").out
    drawn = bytes_of(out, ".png")
    assert len(drawn) == 1 + 4 * (1 + 4) + 2 * 2 and bytes_of(out, ".exr") == kept
    assert drawn["scene_4spp.png"] and drawn["scene_multiscale_directional_4spp.png"]
    good("picture", "out", "--threads", 1)
    assert bytes_of(out, ".png") == drawn
    good(*words, "-o", "out", "--force")  # pictures of other images do not stay
    assert set(bytes_of(out, ".png")) == {"scene_4spp.png"} and bytes_of(out, ".exr") == kept
    good(*words, "-o", "none", "--no-pictures")
    run("picture", "none").failed_with(1, "none: no images of results in it", "--no-pictures")
    run("picture", "out", "-o", "x.png").failed_with(2, "-o x.png: pictures of results lie beside them")
    run("picture", "out", "--exposure", 1).failed_with(2, "out: is a folder", "left out")
    run("picture", out / "scene_reference.exr").failed_with(2, "is no folder of results", "-o PICTURE.png")
    (out / "scene_uniform_box_4spp" / "estimate.exr").write_bytes(kept["scene_uniform_box_4spp/estimate.exr"][:500])
    run("picture", "out").failed_with(4, "scene_uniform_box_4spp/estimate.exr")


def test_force_takes_images_and_pictures_of_earlier_results_and_no_file_of_the_user(good, run, dump, tmp_path):
    """Report and figure showed them beside the new numbers."""
    words = ("evaluate", dump, "--filters", "box,directional", "--spp", 4, "--replicates", 1)
    out = tmp_path / "out"
    own = {out / name for name in ("scene_uniform_box_4spp/mine.exr", "scene_uniform_box_4spp/estimate.txt", "mine/estimate.exr", "scene.png")}

    def made_before():
        good(*words, "--reference", "leave_selected_out", "-o", "out")
        good("picture", "out")
        for path in own:
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(b"mine")
        assert (out / "scene_uniform_directional_4spp" / "reference.exr").exists() and (out / "scene_uniform_directional_4spp.png").exists()

    def images():
        return {path for path in out.rglob("*") if path.suffix in (".exr", ".png", ".txt")}

    made_before()
    (out / "manifest-shard-0-of-2.json").write_text('{"shard": "0/2"}')
    good("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "-o", "out", "--force")  # by fewer methods
    assert "shards" not in json.loads((out / "manifest.json").read_text())
    assert images() == own and all(path.read_bytes() == b"mine" for path in own)
    good(*words, "-o", "out", "--force")
    made_before_again = images()
    assert not list(out.glob("*/reference.exr")) and (out / "scene_reference.exr").exists()
    # A kill after the first of what goes: nothing is taken for new, and the rest goes with the next --force.
    shutil.rmtree(out / "cells")
    run(*words, "--no-pictures", "-o", "out").failed_with(2, "holds no results that could be continued", "--force")
    assert images() == made_before_again
    (out / "plan.toml").write_text("of another program")
    good(*words, "--no-pictures", "-o", "out", "--force")
    assert images() == own


def test_pictures_are_those_drawn_at_once(good, dump, tmp_path):
    """`reconstruct --pictures` draws what it has in memory, an evaluation's images are drawn from their files of floats."""
    good("evaluate", dump, "--samplers", "multiscale", "--filters", "directional", "--spp", 4, "--recorded-order", "--replicates", 1, "-o", "out")
    good("picture", "out")
    good("replay", dump, "--sampler", "multiscale", "--spp", 4, "-o", "n.exr")
    good("reconstruct", dump, "--selection", "n.exr", "--filter", "directional", "--pictures", "once", "-o", "image.exr")
    late, once = tmp_path / "out" / "scene_multiscale_directional_4spp", tmp_path / "once"
    assert (read_exr(late / "estimate.exr", "G") == read_exr(tmp_path / "image.exr", "G")).all()
    for name in ("filter_size", "direction", "squared_error", "estimate", "flip"):
        assert (late / f"{name}.png").read_bytes() == (once / f"{name}.png").read_bytes(), name


def test_picture_makes_the_flip_map_of_a_named_result_alone(good, dump, tmp_path):
    good("evaluate", dump, "--spp", "4,8", "--samplers", "uniform", "--filters", "box", "--set", "metrics.perceptual=none", "-o", tmp_path / "out")
    first, second = (tmp_path / f"out/scene_uniform_box_{spp}spp/flip.exr" for spp in (4, 8))
    good("picture", tmp_path / "out", "--flip-map", "scene_uniform_box_4spp", "--flip-map", "scene_uniform_box_4spp")
    assert first.exists() and not second.exists() and not first.with_name("estimate.png").exists()
    made = first.read_bytes()
    good("report", tmp_path / "out", "-o", tmp_path / "r.html")
    assert second.exists() and first.read_bytes() == made


@pytest.mark.parametrize("where, name, code, words", [("out", "nowhere", 1, "there are no images of a result 'nowhere'"),
                                                      ("out", "../out", 1, "there are no images of a result '../out'"),
                                                      ("out/scene_uniform_box_4spp/estimate.exr", "x", 2, "is no folder of results")])
def test_picture_has_no_flip_map_of_what_is_no_result(good, run, dump, tmp_path, where, name, code, words):
    good("evaluate", dump, "--spp", "4", "--samplers", "uniform", "--filters", "box", "-o", tmp_path / "out")
    done = run("picture", tmp_path / where, "--flip-map", name)
    assert done.code == code and words in done.err


def test_a_report_makes_the_flip_maps_that_no_metric_needed(good, dump, tmp_path):
    good("evaluate", dump, "--spp", 4, "--replicates", 2, "--set", "metrics.perceptual=none", "-o", "out")
    flip = tmp_path / "out" / "scene_uniform_box_4spp" / "flip.exr"
    assert not flip.exists()
    good("report", "out", "-o", "page.html")
    made = flip.read_bytes()
    assert '"flip":' in (tmp_path / "page.html").read_text()
    good("picture", "out")
    assert flip.read_bytes() == made


def test_results_do_not_depend_on_threads(good, dump, tmp_path):
    for threads in (1, 3):
        good("evaluate", dump, "--filters", "box,gaussian", "--spp", "2,4", "--replicates", 2,
             "--no-pictures", "--threads", threads, "-o", f"t{threads}")
    one, three = (rows_of(tmp_path / f"t{t}") for t in (1, 3))
    for a, b in zip(one, three):
        assert [a[k] for k in ("mse", "relmse", "energy_ratio")] == \
               [b[k] for k in ("mse", "relmse", "energy_ratio")]


def test_errors_are_found_before_the_work(run, good, dump, tmp_path):
    run("evaluate", dump, "--spp", 99, "-o", "out").failed_with(1, "the recording has 16")
    run("evaluate", dump, "--spp", "4,x", "-o", "out").failed_with(2, "--spp")
    run("evaluate", "none.spool", "--spp", 4, "-o", "out").failed_with(3, "none.spool")
    run("evaluate", dump, "--spp", 4, "--samplers", "unifrom", "-o", "out").failed_with(2, "uniform")
    run("evaluate", dump, "--spp", 4, "--reference", "best", "-o", "out").failed_with(2, "best")
    run("evaluate", dump, "--spp", 4, 8, "-o", "out").failed_with(2, "--spp A,8")
    run("evaluate", dump, "--spp", 4, "--samplers", "uniform", "multiscale", "-o", "out").failed_with(2, "--samplers A,multiscale")
    run("evaluate", dump, "--spp", 4, "--filters", "multiscale", "-o", "out").failed_with(2, "is a sampler")
    run("evaluate", dump, "--spp", 4, "--samplers", "directional", "-o", "out").failed_with(2, "is a filter")
    run("evaluate", tmp_path, "--spp", 4, "-o", "out").failed_with(3, "is a folder")
    assert not (tmp_path / "out").exists()
    good("evaluate", dump, "--spp", 4, "-o", "out", "--no-pictures")
    run("evaluate", dump, "--spp", 2, "-o", "out").failed_with(2, "--force")


def test_images_of_two_methods_have_two_names(run, good, dump, tmp_path):
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "-o", "out")
    run(*command, "--filters", "a_=box,a=gaussian").failed_with(2, "their images would have one name")
    run(*command, "--samplers", "a_c=uniform,a=mitchell", "--filters", "d=box,c_d=gaussian").failed_with(2, "their images would have one name")
    assert not (tmp_path / "out").exists()
    good(*command, "--filters", "a_=box,a=gaussian", "--no-pictures")


def test_no_plan_is_replaced_by_its_own_results(good, run, dump, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text('# mine\nrecordings = ["scene.spool"]\nspp = [4]\nreplicates = 1\nsamplers = ["uniform"]\nfilters = ["box"]\n')
    run("evaluate", plan, "-o", ".", "--no-pictures", "--force").failed_with(2, "plan.toml: output is the input")
    assert plan.read_text().startswith("# mine") and not (tmp_path / "cells").exists()
    good("evaluate", plan, "-o", "out", "--no-pictures")
    good("evaluate", "out/plan.toml", "-o", "out", "--no-pictures", "--force")


@pytest.mark.parametrize("name", ["manifest.json", "results.csv"])
def test_force_replaces_no_results_of_other_programs(good, run, dump, tmp_path, name):
    other = tmp_path / "out" / name
    other.parent.mkdir()
    (other.parent / "notes.txt").write_text("mine")
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "-o", "out", "--force")
    good(*command)
    for path in other.parent.iterdir():
        if path.name != "notes.txt":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    other.write_text("of another program")
    run(*command).failed_with(2, f"{name}: no evaluation wrote it")
    assert {path.name for path in other.parent.iterdir()} == {name, "notes.txt"} and other.read_text() == "of another program"


def test_force_begins_anew_whatever_was_kept(good, dump, tmp_path):
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "-o", "out")
    good(*command)
    cells = next((tmp_path / "out" / "cells").glob("*.jsonl"))
    cells.rename(tmp_path / "out" / "kept.jsonl")
    good(*command, "--force")
    assert not (tmp_path / "out" / "kept.jsonl").exists() and list((tmp_path / "out" / "cells").glob("*.jsonl"))


def test_two_plans_at_once_are_not_one_folder(run, good, dump, tmp_path):
    """The other one finishes a result while this one runs."""
    good("evaluate", dump, "--spp", 2, "--replicates", 1, "--no-pictures", "-o", "other")
    own = tmp_path / "own.sh"
    own.write_text(f"#!/bin/sh\ncp {tmp_path}/other/cells/*.jsonl {tmp_path}/out/cells\ncp $1 $2\n")
    run("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "--filters", f"own=exec:sh {own}", "-o", "out").failed_with(
        2, "another plan was run in it meanwhile")
    assert len(list((tmp_path / "out" / "cells").glob("*.jsonl"))) == 2 and not (tmp_path / "out" / "results.csv").exists()


def test_shards_that_start_at_once_keep_each_others_input_files(good, dump, tmp_path):
    good("replay", dump, "--sampler", "uniform", "--spp", 4, "-o", "n.exr")
    (tmp_path / "plan.toml").write_text(f'recordings = ["{dump}"]\nspp = [4]\nreplicates = 2\nsamplers = ["counts:n.exr"]\nfilters = ["box"]\n')
    for attempt in range(20):
        out = tmp_path / f"out_{attempt}"
        (out / "cells").mkdir(parents=True)
        lock = os.open(out / "cells", os.O_RDONLY)
        fcntl.flock(lock, fcntl.LOCK_EX)
        begin = time.monotonic()
        shard = subprocess.Popen([PROGRAM, "evaluate", "plan.toml", "-o", out, "--shard", "0/2"], cwd=tmp_path, stdout=subprocess.DEVNULL)
        while not (out / "plan.toml").exists():  # the last that it writes before
            assert shard.poll() is None
            time.sleep(0.01)
        (out / "inputs.json").write_text('{"/of/another": {}}')
        os.close(lock)
        held = time.monotonic() - begin
        assert shard.wait(LONGEST_RUN) == 0
        if held < 0.9:  # it waits for a second
            break
    assert set(json.loads((out / "inputs.json").read_text())) == {"/of/another", str(tmp_path / "n.exr")}


def test_a_shard_notices_a_changed_input_of_the_results_of_another(run, good, dump, tmp_path):
    (tmp_path / "plan.toml").write_text(f'recordings = ["{dump}"]\nspp = [4]\nreplicates = 8\nsamplers = ["counts:n.exr"]\nfilters = ["box"]\n')
    for shard, spp in enumerate((4, 2)):
        good("replay", dump, "--sampler", "uniform", "--spp", spp, "-o", "n.exr", "--force")
        if shard == 0:
            good("evaluate", "plan.toml", "-o", "out", "--shard", "0/2")
    run("evaluate", "plan.toml", "-o", "out", "--shard", "1/2").failed_with(2, "n.exr: has changed since the results in out were made")


@pytest.mark.parametrize("kind", ["command", "part", "loop", "image", "counts", "mask"])
def test_results_of_an_input_that_was_changed_are_not_kept(run, good, dump, tmp_path, kind):
    for name, spp in (("a.exr", 2), ("b.exr", 4)):
        good("replay", dump, "--sampler", "uniform", "--spp", spp, "-o", f"n_{name}")
        good("reconstruct", dump, "--filter", "box", "--spp", spp, "-o", name)
    given = tmp_path / "of mine"
    samplers, filters, more, files = '"uniform"', '"box"', "", ("a.exr", "b.exr")
    if kind in ("command", "part", "loop"):
        (tmp_path / "a.exr").write_text("cp $1 $2")
        (tmp_path / "b.exr").write_text("sleep 0; cp $1 $2")
        command = 'exec:sh "of mine" 2> log.txt'
        filters = {"command": f"'own={command}'", "part": f"'own=ensemble:box+{command}'", "loop": filters}[kind]
        samplers = f"'own=cross_halves{{filter={command}}}'" if kind == "loop" else samplers
    if kind == "image":
        filters = '"image:of mine"'
    if kind == "counts":
        samplers, files = '"counts:of mine"', ("n_a.exr", "n_b.exr")
    if kind == "mask":
        more = '[[mask]]\nname = "m"\nfile = "of mine"\n'
    (tmp_path / "plan.toml").write_text(f'recordings = ["{dump}"]\nspp = [4]\nreplicates = 1\npictures = false\nsamplers = [{samplers}]\n'
                                        f"filters = [{filters}]\n{more}")
    for number, name in enumerate(files):
        given.write_bytes((tmp_path / name).read_bytes())
        if number == 0:
            good("evaluate", "plan.toml", "-o", "out")
            (tmp_path / "log.txt").write_text("written again")
            good("evaluate", "plan.toml", "-o", "out")
    run("evaluate", "plan.toml", "-o", "out").failed_with(2, "of mine: has changed since the results in out were made", "--force")
    good("evaluate", "plan.toml", "-o", "other")
    run("evaluate", "plan.toml", "--merge", "-o", "merged", "--from", "out", "--from", "other").failed_with(
        2, "of mine: was another file when the results in other were made")
    assert not (tmp_path / "merged").exists()
    good("evaluate", "plan.toml", "--merge", "-o", "merged", "--from", "other")
    given.write_bytes((tmp_path / files[0]).read_bytes())
    run("evaluate", "plan.toml", "-o", "merged").failed_with(2, "of mine: has changed")
    good("evaluate", "plan.toml", "-o", "out", "--force")
    good("evaluate", "plan.toml", "-o", "out")


def test_a_command_that_failed_may_be_mended(run, good, dump, tmp_path):
    own = tmp_path / "own.sh"
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "--filters", "box,own=exec:sh own.sh", "-o", "out")
    own.write_text("exit 1\n")
    run(*command).failed_with(1, "1 of 2 results failed")
    own.write_text("cp $1 $2\n")
    good(*command)


def test_a_failed_result_has_no_image_of_an_earlier_run(good, run, dump, tmp_path):
    works = tmp_path / "works.sh"
    works.write_text("#!/bin/sh\ncp $1 $2\n")
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "--filters", f"box,own=exec:sh {works}", "-o", "out")
    good(*command)
    image = tmp_path / "out" / "scene_uniform_own_4spp" / "estimate.exr"
    assert image.is_file()
    works.write_text("#!/bin/sh\nexit 1\n")
    run(*command, "--force").failed_with(1, "own")
    assert not image.exists()
    good("report", "out", "-o", "page.html")


def test_counts_of_a_file_may_be_more_than_a_half_has(good, dump, tmp_path):
    exr.write(tmp_path / "counts.exr", {"n": np.where(np.arange(24) < 12, 12, 4)[None, :].repeat(20, axis=0).astype("u4")})
    good("evaluate", dump, "--spp", 8, "--samplers", "uniform,counts:counts.exr", "--replicates", 4, "--no-pictures", "-o", "out")
    assert not any(row["error"] for row in rows_of(tmp_path / "out"))


def test_a_claim_with_a_limit_says_it(good, dump, tmp_path):
    (tmp_path / "plan.toml").write_text(
        f'recordings = ["{dump}"]\nspp = [4]\nreplicates = 4\npictures = false\nsamplers = ["uniform"]\nfilters = ["box", "gaussian"]\n'
        '[[claim]]\nbetter = "uniform + gaussian"\nthan = "uniform + box"\nbelow = 4\n')
    assert "uniform + gaussian has less than 4 times the error of uniform + box" in good("evaluate", "plan.toml", "-o", "out").out


def test_settings_reach_the_methods_that_have_them(good, run, dump, tmp_path):
    command = ("evaluate", dump, "--spp", 4, "--replicates", 1, "--no-pictures", "--filters", "box,gaussian")
    good(*command, "--set", "filter.sigma=2", "-o", "a")
    good(*command, "--set", "gaussian.sigma=2", "-o", "b")
    good(*command, "-o", "c")
    a, b, c = ([r["mse"] for r in rows_of(tmp_path / name)] for name in "abc")
    assert a == b and a[0] == c[0] and a[1] != c[1]
    run(*command, "--set", "filter.sigmaa=2", "-o", "d").failed_with(2, "did you mean 'sigma'")


def test_pool_too_small_for_a_holdout_still_is_judged(good, tmp_path):
    radiance, _ = samples(8, 8, 8)
    path = write_dump(tmp_path / "short.spool", radiance)
    good("evaluate", path, "--spp", 2, "--replicates", 1, "--no-pictures", "-o", "out")
    assert rows_of(tmp_path / "out")[0]["mse"] not in ("", "nan")


@pytest.mark.parametrize("options, said", [(("holdout", "--holdout", 0), "0 held-out samples per pixel cannot judge: hold out at least 3"),
                                           (("holdout_pair", "--holdout", 4), "4 held-out samples per pixel cannot judge: hold out at least 5"),
                                           (("holdout",), "0 held-out samples per pixel cannot judge: hold out at least 3"),
                                           (("independent",), "holds no independent reference: judge by --reference holdout")])
def test_what_can_judge_no_image_is_an_error_before_work(run, tmp_path, options, said):
    path = write_dump(tmp_path / "short.spool", samples(8, 8, 8)[0])
    run("evaluate", path, "--spp", 2, "--replicates", 1, "-o", "out", "--reference", *options).failed_with(1, f"short.spool: {said}")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("reference, offered", [("holdout", 16), ("leave_selected_out", 29), ("crossfit", 16), ("independent", 32)])
def test_a_budget_beyond_what_samplers_are_offered_is_refused_before_work(good, run, tmp_path, reference, offered):
    radiance, mean = samples(8, 8, 32)
    exact = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    path = write_dump(tmp_path / "r.spool", radiance, reference=exact, reference_variance=np.zeros_like(exact))
    command = ("evaluate", path, "--reference", reference, "--replicates", 1, "--no-pictures", "-o", "out", "--spp")
    said = [f"of which samplers are offered {offered} ({reference})"] if offered < 32 else []
    run(*command, offered + 0.5).failed_with(1, f"{offered + 0.5} samples per pixel asked for, the recording has 32", *said)
    assert not (tmp_path / "out").exists()
    good(*command, offered)
    assert float(rows_of(tmp_path / "out")[0]["samples_spent"]) == offered * 64


@pytest.mark.parametrize("reference", ["independent", "holdout", "holdout_pair", "leave_selected_out", "crossfit", "pool"])
def test_every_kind_of_reference_works(good, tmp_path, reference):
    radiance, mean = samples(16, 16, 48)
    exact = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    path = write_dump(tmp_path / "r.spool", radiance, reference=exact,
                      reference_variance=np.zeros_like(exact))
    text = good("evaluate", path, "--spp", 4, "--reference", reference, "--no-pictures", "-o", "out").out
    assert reference in text and ("BIASED" in text) == (reference == "pool")


def test_of_many_methods_the_baseline_is_shown_and_no_sheet_is_said_to_be_missing(good, tmp_path):
    path = write_dump(tmp_path / "r.spool", samples(height=8, width=8)[0])
    sigmas = ",".join(f"gaussian{{sigma={0.2 + 0.01 * i:.2f}}}" for i in range(30))
    good("evaluate", path, "--filters", "box,gaussian{sigma=0.20}", "--spp", "1,2", "--replicates", 2, "-o", "out")
    assert (tmp_path / "out/r_1spp.png").exists()
    text = good("evaluate", path, "--filters", f"box,{sigmas}", "--spp", "1,2,3,4,5,6,7", "--replicates", 2, "-o", "out").out
    assert "ratio to uniform + box" in text and "and the baseline, of 217 in all" in text and "no ratio" not in text
    assert text.count("(baseline)") == 7 and "no sheet of more than 24 estimates" in text
    assert not list((tmp_path / "out").glob("r_*spp.png"))  # one of the smaller plan would show some of the results only
    rules = json.loads((tmp_path / "out/statistics.json").read_text())["rules"]
    assert "order_low" in rules["order"] and "order_low" not in rules["interval"] + rules["verdict"]  # which the report prints


def test_documentation_explains_every_column(good):
    page = (Path(__file__).parents[2] / "docs" / "results.md").read_text()
    metrics = {metric["name"] for metric in good("list", "metrics", "--json").json}
    for column in good("list", "columns", "--json").json:
        name = column["name"]
        described = name[:-3] if name.endswith("_se") and name[:-3] in metrics else name
        if not described.startswith("energy_ratio_d"):
            assert f"`{described}`" in page, name


def test_results_beside_each_other_are_those_one_after_another(good, dump, tmp_path):
    common = ["evaluate", dump, "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", "2,4",
              "--replicates", 3, "--threads", 3, "--quiet"]
    good(*common, "-o", tmp_path / "shared")
    good(*common, "--timing", "exact", "-o", tmp_path / "exact")
    assert_same_results(tmp_path / "shared", tmp_path / "exact", images=True)
    for folder, timing in (("shared", "shared"), ("exact", "alone")):
        rows = rows_of(tmp_path / folder)
        assert {row["timing"] for row in rows} == {timing}
        assert {row["threads_used"] for row in rows} == {"1" if timing == "shared" else "3"}
        assert all((row["peak_memory_mb"] == "") == (timing == "shared") for row in rows)


def test_times_of_a_shared_machine_are_no_exact_ones(good, run, dump, tmp_path):
    """The results stayed as they were, and the manifest said that they were timed exactly."""
    words = ["evaluate", dump, "--spp", 2, "--replicates", 3, "--threads", 3, "--no-pictures", "-o", "out"]
    said = " ".join(good(*words, "--wide").out.split())
    assert "--timing exact --force makes them anew" in said
    kept = bytes_of(tmp_path / "out", "")
    for more in ([], ["--dry-run"]):
        run(*words, "--timing", "exact", *more).failed_with(2, "--timing exact: results in out were timed beside others", "--force")
    shard = run(*words, "--timing", "exact", "--shard", "0/1")
    assert shard.code == 2 and "choose another folder" in shard.err and "--force" not in shard.err
    assert bytes_of(tmp_path / "out", "") == kept
    for more in (["--force"], [], ["--shard", "0/1"]):
        good(*words, "--timing", "exact", *more)
        assert {row["timing"] for row in rows_of(tmp_path / "out")} == {"alone"}


def test_a_recording_has_a_name_and_its_path_stands_apart(good, dump, tmp_path):
    (tmp_path / "else").mkdir()
    other = tmp_path / "else" / "scene.spool"
    other.write_bytes(dump.read_bytes())
    for path, out in ((dump, "one"), (other, "two")):
        good("evaluate", path, "--spp", 2, "--replicates", 1, "--no-pictures", "-o", out, "-q")
        rows = rows_of(tmp_path / out)
        assert {(row["dump"], row["dump_path"]) for row in rows} == {("scene", str(path))}


def test_metrics_that_a_plan_names_are_the_bits_of_all(good, run, dump, tmp_path):
    text = f'recordings = ["{dump}"]\nspp = [2, 4]\nreplicates = 3\nsamplers = ["uniform"]\nfilters = ["box", "gaussian"]\nfresh = true\n'
    (tmp_path / "all.toml").write_text(text)
    (tmp_path / "some.toml").write_text(text + 'metrics = ["ssim"]\n')
    for name in ("all", "some"):
        good("evaluate", f"{name}.toml", "-o", name, "--no-pictures")
    known = {"relmse", "mse", "energy_ratio", "ssim"}
    metrics = {metric["name"] for metric in good("list", "metrics", "--json").json}
    for row, other in zip(rows_of(tmp_path / "all"), rows_of(tmp_path / "some"), strict=True):
        for name in metrics:
            if name in known:
                assert other[name] == row[name] and other[f"{name}_se"] == row[f"{name}_se"], name
            else:
                assert other[name] == "" and other[f"{name}_se"] == "", name
    assert_same_results(tmp_path / "all", tmp_path / "some", apart=metrics | {f"{name}_se" for name in metrics})
    kept = [json.loads((tmp_path / name / "statistics.json").read_text()) for name in ("all", "some")]
    assert [c for c in kept[0]["conditions"] if c["metric"] in known] == kept[1]["conditions"]
    (tmp_path / "wrong.toml").write_text(text + 'metrics = ["sim"]\n')
    run("evaluate", "wrong.toml", "-o", "wrong").failed_with(2, "wrong.toml:7: unknown metric 'sim', did you mean 'ssim'?")
    good("report", "some", "-o", "page.html")
    good("evaluate", "some/plan.toml", "-o", "some", "--no-pictures")


def test_a_black_reference_is_told(good, tmp_path):
    radiance, _ = samples()
    write_dump(tmp_path / "dark.spool", radiance, reference=np.zeros((*radiance.shape[:2], 3), "<f4"))
    words = ("evaluate", "dark.spool", "--samplers", "uniform", "--filters", "box", "--spp", 2, "--replicates", 2, "--no-pictures", "-o", "black")
    for _ in range(2):  # where all results are there, too
        assert "warning: dark.spool: its reference is black and results are not" in good(*words).err
