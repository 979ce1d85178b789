"""`spool metrics A.exr B.exr`: against numpy, with masks, and what it refuses."""
import numpy as np
import pytest

from conftest import read_exr


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
    found = good("metrics", images[0], images[0], "--json").json["metrics"]
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


def test_what_does_not_fit_is_refused(run, good, images, dump):
    run("metrics", "a.exr", "none.exr").failed_with(3, "none.exr")
    run("metrics", "a.exr", dump).failed_with(1, "scene.spool")
    run("metrics", *images, "--set", "tirm=0.1").failed_with(2, "did you mean 'trim'")
    good("synth", "scene_s", "--size", "16x9", "--samples", 4, "-o", "other.spool")
    good("reconstruct", "other.spool", "--filter", "box", "-o", "small.exr")
    run("metrics", "small.exr", "b.exr").failed_with(1, "16 x 9", "24 x 20")
