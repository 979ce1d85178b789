"""`spool pixel`: the samples of a pixel in the order of a replay."""

from pathlib import Path

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


def test_equal_samples_give_no_interval(good, tmp_path):
    radiance = np.full((8, 8, 4, 3), 0.3, np.float32)
    radiance[0, 1, 3] = 2.0                       # the first three of this pixel are equal
    spool.write(tmp_path / "equal.spool", radiance)
    for at, bounded in (("0,0", []), ("1,0", [3])):
        pixel, = good("pixel", tmp_path / "equal.spool", "--at", at, "--json").json
        ends = [i for i, low in enumerate(pixel["low"]) if low is not None and np.isfinite(low)]
        assert ends == bounded and pixel["mean"][2] == pytest.approx(0.3, rel=1e-6)


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


def test_widths_of_a_footprint_are_parted_by_semicolons_and_end_without(good):
    chess = Path(__file__).parents[2] / "dumps/tiny/chess.spool"
    line = next(text for text in good("pixel", chess, "--at", "20,30", "--sampler", "uniform", "--spp", "8", "--filter",
                                      "directional").out.splitlines() if text.startswith("footprint"))
    assert "degrees; " in line and line.endswith("degrees"), line


def test_what_is_wrong_is_named(run, scene):
    run("pixel", scene, "--at", "16,0").failed_with(2, "15,15")
    run("pixel", scene, "--at", "1").failed_with(2, "X,Y")
    run("pixel", scene, "--at", "-1,2").failed_with(2, "X,Y")
    for alone in (("--sampler", "uniform"), ("--spp", "4"), ("--spp", "0")):
        run("pixel", scene, "--at", "1,2", *alone).failed_with(2, "--sampler and --spp go together")
    run("pixel", scene, "--at", "1,2", "--sampler", "uniform", "--spp", "0").failed_with(2, "spp: 0 is outside 0.001 .. 65536")
    text = run("pixel", scene, "--at", "1,2", "--samples", "3")
    assert text.code == 0 and len(text.out.strip().splitlines()) == 5


@pytest.mark.parametrize("filter_", ["directional", "gaussian", "nl_means", "box", "welch", "wavelet_shrinkage"])
def test_a_footprint_makes_the_pixel_of_replay_and_reconstruct(good, scene, tmp_path, filter_):
    good("replay", scene, "--sampler", "multiscale", "--spp", "4", "-o", tmp_path / "n.exr", "-q")
    good("reconstruct", scene, "--selection", tmp_path / "n.exr", "--filter", filter_, "-o", tmp_path / "i.exr", "-q")
    counts, image = exr.read(tmp_path / "n.exr")["n"], exr.read(tmp_path / "i.exr")
    places = ((0, 0), (7, 5), (15, 9))
    pixels = good("pixel", scene, *[w for x, y in places for w in ("--at", f"{x},{y}")], "--sampler", "multiscale", "--spp", "4",
                  "--filter", filter_, "--json").json
    for (x, y), pixel in zip(places, pixels):
        assert pixel["taken"] == counts[y, x]
        made = [image[c][y, x] for c in "RGB"]
        np.testing.assert_allclose(pixel["image"], made, rtol=1e-6)
        taps = np.array(pixel["footprint"]["taps"])
        assert taps[:, 2].sum() == pytest.approx(1.0, abs=1e-7)  # nl_means weighs in float
        np.testing.assert_allclose(taps[:, 2] @ taps[:, 3:], made, rtol=1e-5)
        if filter_ not in ("nl_means", "wavelet_shrinkage"):  # whose taps are means of halves, or of channels that shrink apart
            for tx, ty, _, *value in taps[:4]:
                there, = good("pixel", scene, "--at", f"{int(tx)},{int(ty)}", "--json").json
                n = int(counts[int(ty), int(tx)])
                np.testing.assert_allclose(value, np.mean(there["samples"][:n], axis=0), rtol=1e-5)


def test_a_filter_that_cannot_say_says_so(run, good, scene):
    pixel, = good("pixel", scene, "--at", "3,3", "--sampler", "uniform", "--spp", "4", "--filter", "clamped", "--json").json
    assert pixel["footprint"] is None and len(pixel["image"]) == 3
    text = good("pixel", scene, "--at", "3,3", "--sampler", "uniform", "--spp", "4", "--filter", "directional").out
    assert "footprint: size" in text and "uniform took 4" in text
    run("pixel", scene, "--at", "3,3", "--filter", "box").failed_with(2, "--sampler")
    run("pixel", scene, "--at", "3,3", "--sampler", "uniform").failed_with(2, "spp")
    run("pixel", scene, "--at", "3,3", "--sampler", "uniform", "--spp", "99", "--filter", "box").failed_with(1, "record more")
