"""Results folders where names are long or look like formulas, where pictures or dumps.json cannot be used."""

import csv
import json

import numpy as np
import pytest

from conftest import samples, write_dump


def evaluate(good, *words):
    return good("evaluate", *words, "--filters", "box,gaussian", "--spp", "4", "--replicates", "2", "-q")


def rows(folder):
    with open(folder / "results.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("value", [1e30, -3e38])
def test_a_picture_that_cannot_hold_its_numbers_stops_no_evaluation(good, tmp_path, value):
    radiance, mean = samples()
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    reference[1, 15] = value
    write_dump(tmp_path / "hot.spool", radiance, reference=reference, reference_variance=np.zeros_like(reference))
    told = evaluate(good, "hot.spool", "-o", "r")
    assert len(rows(tmp_path / "r")) == 4
    assert told.err.count("warning: 2 of 4 results lack an image") == 1 and "squared_error.exr: channel Y cannot hold" in told.err
    good("picture", "r")
    names = {path.name for path in (tmp_path / "r" / "hot_uniform_box_4spp").iterdir()}
    assert {"estimate.exr", "estimate.png", "density.exr", "flip.exr", "squared_error.png"} <= names and "squared_error.exr" not in names
    good("report", "r", "-o", "page.html")
    assert "warning" not in evaluate(good, "hot.spool", "-o", "n", "--no-pictures").err


def test_names_of_any_length_have_pictures_that_the_report_finds(good, tmp_path):
    long = "n" * 200
    names = [f"{long}a.spool", f"{long}b.spool", "n" * 100 + ".spool"]
    for seed, name in enumerate(names):
        write_dump(tmp_path / name, samples(seed=seed)[0])
    multiscale, = (method for method in good("list", "samplers", "--json").json if method["name"] == "multiscale")
    chosen = ",".join(f"{option['name']}={option['defaults']['paper']}" for option in multiscale["options"])
    sampler = f"multiscale{{{chosen}}}"
    assert len(sampler) > 255
    good("evaluate", *names, "--samplers", f"uniform,{sampler}", "--filters", "box", "--spp", "4", "--replicates", "2", "-q", "-o", "r")
    assert len(list((tmp_path / "r").glob("*/estimate.exr"))) == 6
    assert max(len(path.name) for path in (tmp_path / "r").iterdir()) <= 240
    good("report", "r", "-o", "page.html")
    assert (tmp_path / "page.html").read_text().count('"estimate":') >= 6
    good("figure", "r", "-o", "f")


def test_a_text_that_a_spreadsheet_would_compute_is_kept_text(good, tmp_path):
    for seed, name in enumerate(("=cmd|'calc'!A0.spool", "-1+1.spool", "'quoted.spool", "plain.spool")):
        write_dump(tmp_path / name, samples(seed=seed)[0])
    words = ["./" + name if name.startswith("-") else name for name in sorted(p.name for p in tmp_path.glob("*.spool"))]
    evaluate(good, *words, "-o", "r")
    for row in rows(tmp_path / "r"):
        for name in ("dump", "dump_path", "sampler", "filter", "error"):
            assert row.get(name, "")[:1] not in tuple("=+-@"), row
        float(row["mse"])  # a negative number is one
    lines = [json.loads(line) for line in (tmp_path / "r" / "results.jsonl").read_text().splitlines()]
    assert any(line["dump"].startswith("=cmd") for line in lines)
    good("report", "r", "-o", "page.html")
    good("figure", "r", "-o", "f", "--recording", "-1+1")


@pytest.mark.parametrize("name, value", [("path", 5), ("bytes", "x"), ("bytes", None), ("modified", []), ("sha256", 7), ("sha256", {})])
def test_wrong_types_in_dumps_json_are_one_line(run, good, dump, tmp_path, name, value):
    for folder in ("a", "b"):
        evaluate(good, dump, "-o", folder, "--no-pictures")
    known = json.loads((tmp_path / "a" / "dumps.json").read_text())
    known[0][name] = value
    (tmp_path / "a" / "dumps.json").write_text(json.dumps(known))
    run("compare", "a", "b").failed_with(1, "a/dumps.json: entry 1")
    run("evaluate", "a/plan.toml", "-o", "a", "-q").failed_with(1, "a/dumps.json: entry 1")
    run("evaluate", "b/plan.toml", "--merge", "--from", "a", "-o", "b", "-q").failed_with(1, "a/dumps.json: entry 1")
    evaluate(good, dump, "-o", "a", "--no-pictures", "--force")
