"""`spool picture`: any EXR as a PNG, tone-mapped or in false colour."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "report"))
from exr_writing import write_exr

OpenImageIO = pytest.importorskip("OpenImageIO")


def pixels(path):
    image = OpenImageIO.ImageBuf(str(path))
    return np.rint(255.0 * image.get_pixels(OpenImageIO.FLOAT)).astype(int)[..., :3]


def srgb(value):
    value = np.clip(value, 0.0, 1.0)
    return np.rint(255.0 * np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055))


@pytest.fixture
def image(tmp_path):
    values = np.linspace(0.0, 2.0, 8 * 6 * 3).reshape(6, 8, 3).astype("<f4")
    values[0, 0, 1] = np.nan
    write_exr(tmp_path / "a.exr", {name: np.ascontiguousarray(values[..., c]) for c, name in enumerate("RGB")})
    return values


def test_exposure_and_srgb(good, image, tmp_path):
    for ev in (0, -1.5, 2):
        # A name for each: OpenImageIO keeps the pixels of a name it has read.
        good("picture", tmp_path / "a.exr", "--exposure", ev, "-o", tmp_path / f"a{ev}.png")
        seen = pixels(tmp_path / f"a{ev}.png")
        expected = srgb(image.astype(float) * 2.0 ** ev)
        assert seen.shape == (6, 8, 3) and seen[0, 0].tolist() == [255, 0, 200]  # not finite
        assert np.abs(seen - expected)[1:].max() <= 1


def test_pixels_that_are_not_finite_are_counted_in_one_line(run, image, tmp_path):
    for options in ((), ("--false-colour",), ("--false-colour", "--channel", "G")):
        done = run("picture", tmp_path / "a.exr", "-o", tmp_path / "a.png", "--force", *options)
        assert done.code == 0 and done.err.strip().endswith("a.exr: 1 pixel is not finite"), (options, done.err)


def test_the_exposure_of_another_image_is_taken(good, image, tmp_path):
    write_exr(tmp_path / "b.exr", {name: np.full((6, 8), 0.18 * 4, "<f4") for name in "RGB"})
    good("picture", tmp_path / "a.exr", "--like", tmp_path / "b.exr", "-o", tmp_path / "a.png")
    assert np.abs(pixels(tmp_path / "a.png") - srgb(image.astype(float) / 4))[1:].max() <= 1


def test_false_colour_of_a_channel_has_a_bar_and_grows_lighter(good, image, tmp_path):
    write_exr(tmp_path / "n.exr", {"n": np.arange(1, 17, dtype="u4").reshape(2, 8)})
    good("picture", tmp_path / "n.exr", "--false-colour", "--log", "--range", "1,16", "-o", tmp_path / "n.png")
    sheet = pixels(tmp_path / "n.png")
    assert sheet.shape[1] >= 300 and len({tuple(p) for row in sheet for p in row}) > 30
    good("picture", tmp_path / "a.exr", "--false-colour", "--channel", "G", "-o", tmp_path / "g.png")
    good("picture", tmp_path / "a.exr", "--false-colour", "-o", tmp_path / "y.png")
    assert (pixels(tmp_path / "g.png").shape == pixels(tmp_path / "y.png").shape)


def test_an_empty_variable_names_no_module(run, image, tmp_path):
    done = run("picture", tmp_path / "a.exr", "-o", tmp_path / "a.png", env={**os.environ, "SPOOL_PNG_MODULE": ""})
    assert done.code == 0, done.err
    run("picture", tmp_path / "a.exr", "-o", tmp_path / "b.png", env={**os.environ, "SPOOL_PNG_MODULE": "nosuch"}).failed_with(3, "nosuch")


def test_what_is_wrong_is_named(run, image, tmp_path):
    a, png = tmp_path / "a.exr", tmp_path / "a.png"
    run("picture", a, "-o", tmp_path / "b.exr").failed_with(2, "name it .png")
    run("picture", a, "--false-colour", "--channel", "Z", "-o", png).failed_with(2, "no layer or channel Z", "R")
    run("picture", a, "--false-colour", "--range", "3,1", "-o", png).failed_with(2, "LOW,HIGH")
    run("picture", a, "--false-colour", "--range", "0,1", "--log", "-o", png).failed_with(2, "above 0")
    run("picture", a, "--false-colour", "--like", a, "-o", png).failed_with(2, "--like")
    run("picture", a, "--part", "0zz", "-o", png).failed_with(2, "no part 0zz")
    run("picture", tmp_path / "none.exr", "-o", png).failed_with(3, "none.exr")
    assert not png.exists()
    run("picture", a, "-o", png)
    run("picture", a, "-o", png).failed_with(2, "--force")


def test_list_alone_is_an_overview_and_quiet_is_quiet(run, good, tmp_path):
    overview = good("list").out
    for word in ("samplers", "filters", "multiscale", "directional", "metrics", "scenes"):
        assert word in overview
    names = good("list", "--json").json
    assert "multiscale" in names["samplers"] and "relmse" in names["metrics"]
    assert "iterations" in good("list", "nl_means").out and "multiscale" not in good("list", "nl_means").out
    assert [method["name"] for method in good("list", "nl_means", "--json").json] == ["nl_means"] * 2
    run("list", "twin_giudes").failed_with(2, "did you mean 'twin_guides'")
    good("synth", "scene_s", "--size", "16", "--samples", "16", "-o", tmp_path / "s.spool", "-q")
    assert good("evaluate", tmp_path / "s.spool", "--spp", "2", "--replicates", "2", "-o", tmp_path / "r", "--no-pictures", "-q").out == ""
