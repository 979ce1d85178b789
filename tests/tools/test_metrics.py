"""`spool metrics A.exr B.exr`: against numpy, with masks, and what it refuses."""
import sys
from pathlib import Path

import numpy as np
import pytest
import spool
import spool.exr

from conftest import read_exr

sys.path.append(str(Path(__file__).parents[1] / "interchange"))
import exr_files


@pytest.fixture
def images(good, dump):
    good("reconstruct", dump, "--spp", 4, "--filter", "box", "-o", "a.exr")
    good("reconstruct", dump, "--filter", "box", "-o", "b.exr")
    return "a.exr", "b.exr"


def test_values_are_those_of_numpy(good, images, tmp_path):
    a, b = (np.stack([read_exr(tmp_path / name, c) for c in "RGB"], axis=-1) for name in images)
    found = {k: v["value"] for k, v in good("metrics", *images, "--json", "--set", "rel_scale=none")
             .json["metrics"].items()}
    error = (a - b) ** 2
    assert found["mse"] == pytest.approx(error.mean(), rel=1e-9)
    assert found["rmse"] == pytest.approx(np.sqrt(error.mean()), rel=1e-9)
    assert found["relmse"] == pytest.approx((error / (b ** 2 + 0.01)).mean(), rel=1e-9)
    assert found["mae"] == pytest.approx(np.abs(a - b).mean(), rel=1e-9)
    assert found["smape"] == pytest.approx((np.abs(a - b) / (abs(a) + abs(b) + 0.01)).mean(), rel=1e-9)
    assert found["energy_ratio"] == pytest.approx(a.sum() / b.sum(), rel=1e-9)
    assert found["se_p999"] <= found["se_max"] == pytest.approx(error.mean(axis=2).max(), rel=1e-9)
    for name in ("ssim", "ms_ssim", "flip_ldr", "flip_hdr", "psnr_tm"):
        assert found[name] is not None, name
    text = good("metrics", *images).out
    assert "flip_hdr" in text and "480 pixels judged" in text


def test_an_image_against_itself_has_no_error(good, images):
    done = good("metrics", images[0], images[0], "--json")
    assert "is the reference" in done.err and "is the reference" not in good("metrics", *images).err
    found = done.json["metrics"]
    assert found["mse"]["value"] == 0 and found["ssim"]["value"] == pytest.approx(1)
    assert found["psnr_tm"]["value"] == "inf" and found["flip_ldr"]["value"] == 0


def test_masks_and_the_error_map(good, run, images, tmp_path):
    found = good("metrics", *images, "--json", "--mask", "bright=b.exr", "--error-map", "error.exr")
    a, b = (np.stack([read_exr(tmp_path / name, c) for c in "RGB"], axis=-1) for name in images)
    bright = b.mean(axis=2) > 0.5
    assert found.json["metrics"]["energy_ratio_in_bright"]["value"] == pytest.approx(
        a[bright].sum() / b[bright].sum(), rel=1e-9)
    assert np.allclose(read_exr(tmp_path / "error.exr", "Y"), ((a - b) ** 2).mean(axis=2), rtol=1e-6)
    run("metrics", *images, "--mask", "bright").failed_with(2, "NAME=FILE")
    run("metrics", *images, "--mask", "m=a.exr", "--mask", "m=b.exr").failed_with(2, "--mask m=b.exr", "there twice")
    spool.exr.write(tmp_path / "far.exr", dict.fromkeys("RGB", np.full((20, 24), 1e30, "f4")))
    done = run("metrics", "far.exr", "b.exr", "--error-map", "far_error.exr")
    done.failed_with(1, "far_error.exr", "cannot hold", "scale both images down")
    assert "mse" in done.out and not (tmp_path / "far_error.exr").exists()


@pytest.mark.parametrize("which", ["image", "reference", "both"])
def test_what_is_not_finite_is_one_line_and_exit_1(run, tmp_path, which):
    good, bad = np.ones((4, 6), "f4"), np.ones((4, 6), "f4")
    bad[1, 2], bad[3, 3] = np.nan, np.inf
    for name in ("image", "reference"):
        spool.exr.write(tmp_path / f"{name}.exr", dict.fromkeys("RGB", bad if which in (name, "both") else good))
    done = run("metrics", "image.exr", "reference.exr", "--json")
    assert done.code == 1 and done.err.count("\n") == 1, done.err
    assert ("image" if which == "both" else which) + ".exr: 2 pixels are not finite" in done.err, done.err


def test_pictures_that_do_not_lie_on_each_other_are_refused(run, tmp_path):
    pixels = np.random.default_rng(3).random((4, 6, 3), np.float32)
    def write(name, **windows):
        exr_files.write(tmp_path / name, exr_files.Part(exr_files.rgb(pixels), **windows))
    write("a.exr")
    write("moved.exr", origin=(1, 0), display=(0, 0, 7, 4))
    write("far.exr", origin=(9, 9), display=(9, 9, 6, 4))
    write("part.exr", display=(-5, -5, 20, 20))
    assert run("metrics", "far.exr", "a.exr").code == 0  # the same place of its display
    assert run("metrics", "part.exr", "a.exr").code == 0  # the same pixels
    run("metrics", "moved.exr", "a.exr").failed_with(1, "shows x 1 to 6, y 0 to 3 of its display window")


def test_the_layer_of_both_files_is_chosen(run, good, tmp_path):
    one, two = (np.random.default_rng(s).random((4, 6, 3), np.float32) for s in (4, 5))
    exr_files.write(tmp_path / "a.exr", exr_files.Part(exr_files.rgb(one, "One.Combined") | exr_files.rgb(two, "Two.Combined")))
    exr_files.write(tmp_path / "b.exr", exr_files.Part(exr_files.rgb(one, "x.beauty") | exr_files.rgb(two, "y.beauty")))
    run("metrics", "a.exr", "b.exr").failed_with(1, "choose with --layer One.Combined")
    run("metrics", "a.exr", "b.exr", "--layer", "Two").failed_with(1, "choose with --reference-layer x.beauty")
    found = good("metrics", "a.exr", "b.exr", "--layer", "Two", "--reference-layer", "y.beauty", "--json")
    assert found.json["metrics"]["mse"]["value"] == 0 and "not used: One.Combined" in found.err
    assert run("metrics", "a.exr", "b.exr", "--layer", "Two", "--reference-layer", "y.beauty", "-q").err == ""


def test_the_variance_is_that_layer_of_an_own_image_and_a_variance(run, good, images, dump, tmp_path):
    good("reconstruct", dump, "--spp", 4, "--filter", "directional", "--layers", "-o", "own.exr")
    pixels = {c: read_exr(tmp_path / "own.exr", f"variance.{c}").astype("f4") for c in "RGB"}
    spool.exr.write(tmp_path / "v.exr", pixels)
    assert "nothing is debiased" in good("metrics", *images).out
    assert "debiased without" not in good("metrics", *images, "--variance", "v.exr").out
    alone, own = (good("metrics", *images, "--variance", name, "--json").json for name in ("v.exr", "own.exr"))
    assert own["metrics"] == alone["metrics"] != good("metrics", *images, "--json").json["metrics"]
    for value in (-1, np.nan, np.inf):
        pixels["G"][2, 3] = value
        spool.exr.write(tmp_path / "v.exr", pixels, force=True)
        run("metrics", *images, "--variance", "v.exr").failed_with(1, "v.exr: pixel 3,2", "no variance")


def test_what_does_not_fit_is_refused(run, good, images, dump):
    run("metrics", "a.exr", "none.exr").failed_with(3, "none.exr")
    run("metrics", "a.exr", dump).failed_with(1, "scene.spool")
    run("metrics", *images, "--set", "tirm=0.1").failed_with(2, "did you mean 'trim'")
    good("synth", "scene_s", "--size", "16x9", "--samples", 4, "-o", "other.spool")
    good("reconstruct", "other.spool", "--filter", "box", "-o", "small.exr")
    run("metrics", "small.exr", "b.exr").failed_with(1, "16 x 9", "24 x 20")
