"""evaluate --export-inputs, and image:DIR/{recording}_{spp}_{replicate}.exr, which takes the results back."""
import csv
import json
import re
import shutil

import numpy as np

from conftest import samples, write_dump
from spool import exr

NAMES = "{recording}_{spp}_{replicate}.exr"


def evaluate(run, dump, *options):
    return run("evaluate", dump, "--spp", 4, "--replicates", 3, "--no-pictures", *options)


def errors(folder):
    found = {}
    for row in csv.DictReader((folder / "results.csv").open()):
        found.setdefault(row["filter"], []).append(row["relmse"])
    return found


def test_inputs_that_come_back_as_they_are_judged_as_the_mean(good, dump, tmp_path):
    evaluate(good, dump, "--export-inputs", "inputs", "--seed", 3)
    names = sorted(path.name for path in (tmp_path / "inputs").glob("*.exr"))
    assert names == [f"scene_4_{r}.exr" for r in ("0", "0a", "0b", "1", "1a", "1b", "2")]
    assert {"R", "variance.G", "n"} <= set(exr.read(tmp_path / "inputs" / names[0]))
    evaluate(good, dump, "--seed", 3, "--filters", f"box,mine=image:inputs/{NAMES}", "-o", "results")
    found = errors(tmp_path / "results")
    assert np.allclose(np.double(found["mine"]), np.double(found["box"]), rtol=1e-6, atol=0)  # by way of floats
    entry = next(r for r in json.loads((tmp_path / "results" / "statistics.json").read_text())["results"]
                 if r["filter"] == "mine")
    assert not entry["one_image"] and len(entry["quantities"]["relmse"]) == 3


def test_inputs_go_on_and_are_not_mixed(good, run, dump, tmp_path):
    evaluate(good, dump, "--export-inputs", "inputs")
    kept = next((tmp_path / "inputs").glob("*_4_1.exr"))
    before, missing = kept.stat().st_mtime_ns, next((tmp_path / "inputs").glob("*_4_2.exr"))
    missing.unlink()
    evaluate(good, dump, "--export-inputs", "inputs")
    assert missing.exists() and kept.stat().st_mtime_ns == before
    evaluate(run, dump, "--export-inputs", "inputs", "--seed", 9).failed_with(2, "another plan")
    evaluate(run, dump, "--export-inputs", "inputs", "-o", "results").failed_with(2, "--export-inputs", "-o")


def test_images_that_are_missing_or_wrong_are_named(good, run, dump, tmp_path):
    evaluate(good, dump, "--export-inputs", "inputs")
    name = next((tmp_path / "inputs").glob("*_4_1.exr")).name

    def refused(change, code, *words):
        shutil.rmtree(tmp_path / "images", ignore_errors=True)
        shutil.copytree(tmp_path / "inputs", tmp_path / "images")
        change(tmp_path / "images" / name)
        evaluate(run, dump, "--filters", f"image:images/{NAMES}", "--force", "-o", "results").failed_with(code, name, *words)

    refused(lambda path: path.unlink(), 3, "1 of 3 images are missing")
    refused(lambda path: (path.unlink(), path.symlink_to("nowhere")), 3, "missing")
    small = {c: np.ones((3, 4), "f4") for c in "RGB"}
    refused(lambda path: exr.write(path, small, force=True), 1, "4 x 3")
    holes = {c: np.full((20, 24), np.nan, "f4") for c in "RGB"}
    refused(lambda path: exr.write(path, holes, force=True), 1, "finite")
    evaluate(run, dump, "--filters", "image:inputs/{recording}_{spp}.exr", "-o", "other").failed_with(2, "{replicate}")


def test_an_image_of_a_half_that_was_changed_is_noticed(good, run, dump, tmp_path):
    evaluate(good, dump, "--export-inputs", "images")
    words = (dump, "--filters", f"image:images/{NAMES}", "-o", "results")
    evaluate(good, *words)
    assert {name.rsplit("_", 1)[1] for name in json.loads((tmp_path / "results" / "inputs.json").read_text())} == {
        f"{r}.exr" for r in ("0", "0a", "0b", "1", "1a", "1b", "2")}
    evaluate(good, *words)
    shutil.copy(tmp_path / "images" / "scene_4_0b.exr", tmp_path / "images" / "scene_4_1a.exr")
    evaluate(run, *words).failed_with(2, "images/scene_4_1a.exr: has changed since the results in results were made", "--force")


def test_an_image_that_is_the_reference_is_pointed_out(good, tmp_path):
    radiance, mean = samples()
    mean = mean.astype("f4")
    color = np.ascontiguousarray(mean[:, :, None].repeat(3, axis=2))
    write_dump(tmp_path / "noisy.spool", radiance, reference=color, reference_variance=0.01 * color)
    reference = tmp_path / "reference.exr"
    exr.write(reference, dict.fromkeys("RGB", mean))
    exr.write(tmp_path / "half.exr", dict.fromkeys("RGB", mean.astype("f2").astype("f4")))
    done = evaluate(good, "noisy.spool", "--filters", f"box,image:{reference},half=image:half.exr", "-o", "results")
    assert done.err.count("is the reference of") == 2 and re.search(r"reference.exr +0 \[0, 0\]", done.out)
    entries = json.loads((tmp_path / "results" / "statistics.json").read_text())["results"]
    value, low, high = next(r["quantities"]["relmse"] for r in entries if r["filter"] == "half")
    assert low <= value <= high < 0  # debiased by a noise that it has itself
    said = good("compare", "results", "results").out
    assert said.count("like the reference itself: noisy ") == 1
