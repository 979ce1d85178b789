"""Open Image Denoise itself as a filter, where it is installed; and one line where it is not."""

import numpy as np
import pytest

from spool import exr

MISSING = {"SPOOL_OIDN": "/nowhere/libOpenImageDenoise.so"}


def installed(good_or_run, dump):
    return good_or_run("reconstruct", dump, "--spp", 4, "--filter", "oidn", "-o", "there.exr", "--force").code == 0


def test_without_the_library_it_is_refused_before_any_work(run, dump, tmp_path, monkeypatch):
    for name, value in MISSING.items():
        monkeypatch.setenv(name, value)
    for verb in (("reconstruct", dump, "--spp", 4, "--filter", "oidn", "-o", "i.exr"),
                 ("evaluate", dump, "--filters", "box,oidn", "--spp", 4, "-o", "r")):
        run(*verb).failed_with(2, "oidn", "/nowhere/libOpenImageDenoise.so", "SPOOL_OIDN")
    assert not (tmp_path / "r").exists() and not (tmp_path / "i.exr").exists()


def test_results_are_read_without_the_library(run, good, dump, tmp_path, monkeypatch):
    """A colleague's folder: judged again and compared, though nothing of it could be run here."""
    if not installed(run, dump):
        pytest.skip("Open Image Denoise is not installed: set SPOOL_OIDN to its libOpenImageDenoise.so")
    good("evaluate", dump, "--filters", "box,ensemble:oidn+gaussian", "--spp", 4, "--replicates", 2, "-o", "r")
    for name, value in MISSING.items():
        monkeypatch.setenv(name, value)
    before = (tmp_path / "r/statistics.json").read_bytes()
    good("evaluate", "--statistics-only", "r", "-q")
    assert (tmp_path / "r/statistics.json").read_bytes() == before
    good("compare", "r", "r")
    run("evaluate", "r/plan.toml", "-o", "again").failed_with(2, "ensemble", "/nowhere/libOpenImageDenoise.so", "SPOOL_OIDN")


def test_it_is_listed_whether_it_is_there_or_not(good, monkeypatch):
    for name, value in MISSING.items():
        monkeypatch.setenv(name, value)
    assert "oidn" in good("list", "filters").out


def test_the_library_denoises_and_gives_the_same_bits_for_any_number_of_threads(run, good, dump, tmp_path):
    if not installed(run, dump):
        pytest.skip("Open Image Denoise is not installed: set SPOOL_OIDN to its libOpenImageDenoise.so")
    images = []
    for threads in (1, 2, 3, 8):
        good("reconstruct", dump, "--spp", 4, "--filter", "oidn", "-o", "i.exr", "--force", "--threads", threads)
        images.append(exr.read(tmp_path / "i.exr"))
    for image in images[1:]:
        assert all(np.array_equal(image[c], images[0][c]) for c in "RGB")
    good("reconstruct", dump, "--spp", 4, "--filter", "box", "-o", "box.exr")
    box = exr.read(tmp_path / "box.exr")
    assert np.isfinite(images[0]["G"]).all()
    roughness = lambda image: np.abs(np.diff(image["G"], axis=1)).mean()
    assert roughness(images[0]) < 0.8 * roughness(box)
    good("reconstruct", dump, "--spp", 4, "--filter", "oidn{prefilter=off,quality=fast}", "-o", "fast.exr")
    assert not np.array_equal(exr.read(tmp_path / "fast.exr")["G"], images[0]["G"])
