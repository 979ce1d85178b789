"""Pools that break careless code: one pixel, black, NaN, fireflies, odd sizes."""
import csv
from pathlib import Path

import numpy as np
import pytest

from conftest import read_exr, samples, write_dump


def methods_of(good, what):
    """Those that run on samples alone: no reference, no file, command or library of the user's."""
    return [method["name"] for method in good("list", what, "--json").json
            if "oracle" not in method["summary"] and not method["argument"] and method["name"] != "oidn"]


def write_with_albedo(path, radiance):
    return write_dump(path, radiance, albedo=np.clip(radiance, 0, 1))


@pytest.fixture
def everything(good):
    """Every sampler with every filter on one dump; all images must be finite."""
    def evaluate(dump, spp=2):
        good("evaluate", dump, "--samplers", ",".join(methods_of(good, "samplers")),
             "--filters", ",".join(methods_of(good, "filters")), "--spp", spp,
             "--replicates", 1, "-o", dump.stem, "-q")
    return evaluate


@pytest.mark.parametrize("height, width", [(1, 1), (1, 9), (17, 16)])
def test_small_and_odd_sizes(everything, tmp_path, height, width):
    radiance, _ = samples(height, width)
    everything(write_with_albedo(tmp_path / "odd.spool", radiance))


def test_all_black(everything, good, tmp_path):
    path = write_with_albedo(tmp_path / "black.spool", np.zeros((12, 12, 16, 3), "<f4"))
    everything(path)
    good("reconstruct", path, "--filter", "gaussian", "--pictures", "p", "-o", "black.exr")
    assert (read_exr(tmp_path / "black.exr", "R") == 0).all()


def test_one_firefly(everything, tmp_path):
    radiance, _ = samples(16, 16)
    radiance[8, 8, 0] = 1e6
    everything(write_with_albedo(tmp_path / "firefly.spool", radiance))


def test_negative_radiance(everything, tmp_path):
    radiance, _ = samples(16, 16)
    everything(write_with_albedo(tmp_path / "negative.spool", radiance - 0.5))


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


def hard_dumps(folder):
    """One small dump for each case that a file can carry; the rest is tests/hard_cases."""
    radiance, _ = samples(14, 18, 8)
    few = radiance.copy()
    few[3, 4, 0] = np.nan
    few[5, 6, 1] = np.inf
    few[7, 8, 2] = 3e38
    noisy = radiance.copy()
    noisy[:, ::2] = 0.5
    tails = (1 - np.random.default_rng(5).random((14, 18, 8, 1))) ** (-1 / 0.8) * np.ones(3)
    normal = np.random.default_rng(6).normal(size=radiance.shape)
    normal[2, 3] = np.nan
    cases = {
        "constant": np.full_like(radiance, 0.1), "few_bad": few, "flat_beside_noisy": noisy,
        "one_firefly": np.where(np.arange(radiance.size).reshape(radiance.shape) == 999, 1e6, radiance),
        "subnormal": radiance * 1e-41, "half_overflow": radiance * 65504, "dark": radiance * 2.0**-100,
        "bright": radiance * 2.0**40, "negative": radiance - 0.5, "infinite_variance": tails,
        "large_mean": 1e6 + radiance, "one_sample": radiance[:, :, :1], "one_pixel": radiance[:1, :1],
        "one_row": radiance[:1], "one_column": radiance[:, :1]}
    paths = [write_with_albedo(folder / f"{name}.spool", values.astype("<f4")) for name, values in cases.items()]
    for name, layers in {"features_constant": {"albedo": np.ones_like(radiance), "depth": np.zeros(radiance.shape[:3], "<f4")},
                         "features_nan": {"normal": normal.astype("<f4")}}.items():
        paths.append(write_dump(folder / f"{name}.spool", radiance, **layers))
    return paths


def test_every_method_on_every_hard_dump(good, tmp_path):
    # Every pair of methods runs in tests/hard_cases; here each reads real files.
    paths = hard_dumps(tmp_path)
    samplers, filters = methods_of(good, "samplers"), methods_of(good, "filters")
    for out, chosen in {"samplers": (samplers, ["directional"]), "filters": (["multiscale"], filters)}.items():
        good("evaluate", *paths, "--samplers", ",".join(chosen[0]), "--filters", ",".join(chosen[1]), "--spp", 1,
             "--replicates", 1, "-o", out, "-q")
        with open(tmp_path / out / "results.csv", encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        assert len(rows) == len(paths) * len(chosen[0]) * len(chosen[1])
        for row in rows:
            case = (row["dump"], row["sampler"], row["filter"])
            assert not row["error"], (case, row["error"])
            assert (np.isfinite(float(row["mse"] or "nan"))
                    or Path(row["dump"]).stem in ("one_sample", "one_pixel")), (case, row["mse"])


def test_json_counts_the_guards_of_every_stage(good, tmp_path):
    radiance, _ = samples(16, 16)
    radiance[3, 4, 0] = np.nan
    radiance[8, 9, 1] = 3e38
    path = write_dump(tmp_path / "bad.spool", radiance)
    replayed = good("replay", path, "--sampler", "multiscale", "--spp", 4, "-o", "s.exr", "--json").json
    assert replayed["guards"]["rejected_non_finite"] == 2
    image = good("reconstruct", path, "--selection", "s.exr", "--filter", "directional", "-o", "i.exr", "--json").json
    assert image["guards"]["rejected_non_finite"] == 2
    assert image["guards"]["isotropic_fallback"] > 0
    assert (image["width"], image["height"]) == (16, 16)


def test_budget_above_the_pool_is_refused_before_work(run, tmp_path):
    path = write_dump(tmp_path / "few.spool", samples(12, 12, 4)[0])
    run("replay", path, "--sampler", "uniform", "--spp", 5, "-o", "s.exr").failed_with(1, "few.spool", "use --spp 4")


def test_a_power_of_two_in_the_radiance_scales_every_pixel(good, tmp_path):
    radiance, _ = samples(16, 16)
    images = []
    for name, factor in (("as_it_is", 1.0), ("scaled", 2.0**-40)):
        path = write_dump(tmp_path / f"{name}.spool", (radiance * factor).astype("<f4"))
        good("replay", path, "--sampler", "multiscale", "--spp", 4, "-o", f"{name}_s.exr")
        good("reconstruct", path, "--selection", f"{name}_s.exr", "--filter", "directional", "-o", f"{name}.exr")
        images.append(read_exr(tmp_path / f"{name}.exr", "G"))
    np.testing.assert_array_equal(images[1] / 2.0**-40, images[0])


def test_what_does_not_fit_into_memory_is_refused_before_work(good, tmp_path, run, monkeypatch):
    radiance, _ = samples(40, 40, 16)
    packed = write_dump(tmp_path / "packed.spool", np.repeat(radiance[:, :, :1], 16, axis=2), compress=True)
    plain = write_dump(tmp_path / "plain.spool", radiance)
    # 2 MB for box itself, 81 bytes a pixel; and for the packed one a part of its samples, read block by block.
    monkeypatch.setenv("SPOOL_MEMORY", str(2_000_000 + 40 * 40 * (81 + 3 * 16)))
    run("reconstruct", packed, "--filter", "box", "-o", "i.exr").failed_with(1, "packed.spool", "GB of memory")
    assert not (tmp_path / "i.exr").exists()
    good("reconstruct", plain, "--filter", "box", "-o", "i.exr")  # stays in the file
