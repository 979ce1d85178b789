"""Pools that break careless code: one pixel, black, NaN, fireflies, odd sizes."""
import numpy as np
import pytest

from conftest import read_exr, samples, write_dump


def methods_of(good, what):
    return [method["name"] for method in good("list", what, "--json").json]


def oracles(names):
    return [name for name in names if "oracle" not in name and name != "neyman"]


@pytest.fixture
def everything(good):
    """Every sampler with every filter on one dump; all images must be finite."""
    def evaluate(dump, spp=2):
        good("evaluate", dump, "--samplers", ",".join(oracles(methods_of(good, "samplers"))),
             "--filters", ",".join(oracles(methods_of(good, "filters"))), "--spp", spp,
             "--replicates", 1, "-o", dump.stem, "-q")
    return evaluate


@pytest.mark.parametrize("height, width", [(1, 1), (1, 9), (17, 16)])
def test_small_and_odd_sizes(everything, tmp_path, height, width):
    radiance, _ = samples(height, width)
    everything(write_dump(tmp_path / "odd.spool", radiance))


def test_all_black(everything, good, tmp_path):
    path = write_dump(tmp_path / "black.spool", np.zeros((12, 12, 16, 3), "<f4"))
    everything(path)
    good("reconstruct", path, "--filter", "gaussian", "--pictures", "p", "-o", "black.exr")
    assert (read_exr(tmp_path / "black.exr", "R") == 0).all()


def test_one_firefly(everything, tmp_path):
    radiance, _ = samples(16, 16)
    radiance[8, 8, 0] = 1e6
    everything(write_dump(tmp_path / "firefly.spool", radiance))


def test_negative_radiance(everything, tmp_path):
    radiance, _ = samples(16, 16)
    everything(write_dump(tmp_path / "negative.spool", radiance - 0.5))


def test_few_nan_samples_are_rejected_and_counted(good, tmp_path):
    radiance, _ = samples(40, 40)
    radiance[3, 4, 0] = np.nan
    radiance[3, 5, 1] = np.inf
    path = write_dump(tmp_path / "nan.spool", radiance)
    good("reconstruct", path, "--filter", "box", "-o", "i.exr")
    image = read_exr(tmp_path / "i.exr", "R")
    assert np.isfinite(image).all()
    assert np.isclose(image[3, 4], radiance[3, 4, 1:, 0].mean(), rtol=1e-5)


def test_pool_of_nan_is_refused_with_its_pixel(run, tmp_path):
    radiance, _ = samples(16, 16)
    radiance[5, 7] = np.nan
    path = write_dump(tmp_path / "nan.spool", radiance)
    run("reconstruct", path, "--filter", "box", "-o", "i.exr").failed_with(1, "nan.spool")
    run("evaluate", path, "--spp", 2, "-o", "out").failed_with(1, "nan.spool")
