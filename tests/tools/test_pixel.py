"""`spool pixel`: the samples of a pixel in the order of a replay."""

import numpy as np
import pytest

import spool
from spool import exr


@pytest.fixture
def scene(good, tmp_path):
    good("synth", "scene_s", "--size", "16", "--samples", "32", "--seed", "3", "-o", tmp_path / "s.spool", "-q")
    return tmp_path / "s.spool"


def test_recorded_order_is_that_of_the_file_and_the_interval_is_students(good, scene):
    with spool.open(scene) as dump:
        radiance = dump.read("radiance")[5, 7].astype(float)
    pixel, = good("pixel", scene, "--at", "7,5", "--json").json
    assert (pixel["x"], pixel["y"], pixel["capacity"]) == (7, 5, 32)
    assert pixel["recorded"] == list(range(32))
    np.testing.assert_allclose(pixel["samples"], radiance, rtol=1e-6)
    y = radiance @ [0.2126, 0.7152, 0.0722]
    np.testing.assert_allclose(pixel["mean"], np.cumsum(y) / np.arange(1, 33), rtol=1e-9)
    assert pixel["low"][0] is None or not np.isfinite(pixel["low"][0])
    half = 2.0395134463964077 * y.std(ddof=1) / np.sqrt(32)  # Student's 97.5 % with 31 degrees of freedom
    assert pixel["high"][-1] - pixel["mean"][-1] == pytest.approx(half, rel=1e-6)
    histogram = pixel["histogram"]
    assert sum(histogram["counts"]) + histogram["not_positive"] == 32
    assert histogram["edges"][0] == pytest.approx(y[y > 0].min(), rel=1e-6)


def test_an_evaluations_first_replicate_takes_the_first_of_the_list(good, scene, tmp_path):
    for order in ([], ["--recorded-order"]):
        good("evaluate", scene, "--samplers", "uniform,multiscale", "--spp", "4", "--replicates", "1", "--seed", "9", *order,
             "-o", tmp_path / "r", "--force", "-q")
        choice = ["--order", "recorded"] if order else ["--evaluation-seed", "9"]
        for sampler in ("uniform", "multiscale"):
            folder = tmp_path / "r" / f"s_{sampler}_box_4spp"
            estimate, counts = exr.read(folder / "estimate.exr"), exr.read(folder / "density.exr")["n"]
            for x, y in ((0, 0), (7, 5), (15, 15)):
                pixel, = good("pixel", scene, "--at", f"{x},{y}", *choice, "--json").json
                n = int(counts[y, x])
                mean = np.mean(np.array(pixel["samples"][:n]), axis=0)
                np.testing.assert_allclose([estimate[c][y, x] for c in "RGB"], mean, rtol=1e-5)


def test_what_is_wrong_is_named(run, scene):
    run("pixel", scene, "--at", "16,0").failed_with(2, "15,15")
    run("pixel", scene, "--at", "1").failed_with(2, "X,Y")
    run("pixel", scene, "--at", "-1,2").failed_with(2, "X,Y")
    text = run("pixel", scene, "--at", "1,2", "--samples", "3")
    assert text.code == 0 and len(text.out.strip().splitlines()) == 5
