"""BCD's statistics images and OIDN's image sets against numpy."""
import re

import numpy as np
import OpenImageIO as oiio
import pytest
import spool

from conftest import run_jobs


def planes(path):
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = image.read_image(oiio.FLOAT)
    assert spec.x == 0 and spec.y == 0 and all(spec.channelformat(c) == oiio.TypeFloat for c in range(spec.nchannels))
    return {name: pixels[..., c] for c, name in enumerate(spec.channelnames)}


def histogram(values):
    """[bin], 20 bins, of one component of one pixel: the published formula, straight."""
    bins = np.zeros(20)
    for v in values:
        x = min(max(float(v), 0.0) ** (1 / 2.2) / 2.5, 2.0)
        f = 18 * x
        i = int(np.floor(f))
        if i < 18:
            bins[i] += 1 - (f - i)
            bins[i + 1] += f - i
        else:
            bins[18] += 2 - x
            bins[19] += x - 1
    return bins


def test_mean_covariance_histogram_and_count(tmp_path):
    rng = np.random.default_rng(4)
    samples = (rng.lognormal(0, 2, (6, 11, 7, 3))).astype("f4")
    spool.write(tmp_path / "a.spool", samples, tile_size=8, block_spp=3)
    counts = rng.integers(2, 8, (6, 11))
    spec = oiio.ImageSpec(11, 6, 1, oiio.FLOAT)
    spec.channelnames = ("n",)
    out = oiio.ImageOutput.create(str(tmp_path / "n.exr"))
    assert out.open(str(tmp_path / "n.exr"), spec) and out.write_image(counts[..., None].astype("f4")) and out.close()
    results = run_jobs(("export bcd-stats", tmp_path / "a.spool", tmp_path / "all.exr"),
                       ("export bcd-stats", tmp_path / "a.spool", tmp_path / "some", f"selection={tmp_path / 'n.exr'}"),
                       ("export bcd-stats", tmp_path / "a.spool", tmp_path / "four", "spp=4"))
    assert [code for code, _ in results] == [0, 0, 0], results
    for name, taken in ("all", np.full((6, 11), 7)), ("some", counts), ("four", np.full((6, 11), 4)):
        mean, covariance, bins = (planes(tmp_path / f"{name}{suffix}.exr") for suffix in ("", "_cov", "_hist"))
        assert sorted(bins) == [f"Bin_{i:04}" for i in range(61)] and sorted(covariance) == [f"Bin_{i:04}" for i in range(6)]
        for y, x in np.ndindex(6, 11):
            values = samples[y, x, : taken[y, x]].astype("f8")
            assert np.allclose([mean[c][y, x] for c in "RGB"], values.mean(0), rtol=1e-6)
            expected = np.cov(values.T)
            order = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
            assert np.allclose([covariance[f"Bin_{i:04}"][y, x] for i in range(6)], [expected[pair] for pair in order], rtol=2e-6, atol=1e-12)
            assert np.allclose([[bins[f"Bin_{c * 20 + b:04}"][y, x] for b in range(20)] for c in range(3)],
                               [histogram(values[:, c]) for c in range(3)], atol=1e-5)
            assert bins["Bin_0060"][y, x] == taken[y, x]


def test_histogram_of_known_values(tmp_path):
    values = np.array([1, 2.5**2.2, 20, 100, 0, -3], "f4")
    samples = np.repeat(values.reshape(1, 6, 1, 1), 2, axis=2) * np.ones(3, "f4")
    spool.write(tmp_path / "a.spool", samples)
    code, notes = run_jobs(("export bcd-stats", tmp_path / "a.spool", tmp_path / "p"))[0]
    assert code == 0 and "the image is grey" in notes
    bins = planes(tmp_path / "p_hist.exr")
    at = lambda x: {b: bins[f"Bin_{b:04}"][0, x] / 2 for b in range(20) if bins[f"Bin_{b:04}"][0, x] != 0}
    assert at(0) == pytest.approx({7: 0.8, 8: 0.2}, abs=1e-6)
    assert at(1)[18] == pytest.approx(1, abs=1e-6)
    assert at(2) == pytest.approx({18: 0.438876, 19: 0.561124}, abs=1e-6)
    assert at(3) == {19: 1} and at(4) == {0: 1} and at(5) == {0: 1}
    mean = planes(tmp_path / "p.exr")
    assert mean["B"][0, 0] == np.nextafter(np.float32(1), np.float32(2)) and mean["R"][0, 0] == 1


def test_what_bcd_cannot_hold_is_refused(tmp_path):
    samples = np.ones((2, 3, 4, 3), "f4")
    spool.write(tmp_path / "one.spool", samples[:, :, :1])
    samples[1, 2, 3, 0] = np.nan
    spool.write(tmp_path / "nan.spool", samples)
    one, nan, many = run_jobs(("export bcd-stats", tmp_path / "one.spool", tmp_path / "p"),
                              ("export bcd-stats", tmp_path / "nan.spool", tmp_path / "p"),
                              ("export bcd-stats", tmp_path / "nan.spool", tmp_path / "p", "spp=9"))
    assert one[0] == 1 and "needs two" in one[1]
    assert nan[0] == 1 and "pixel 2,1 sample 3" in nan[1]
    assert many[0] == 2
    assert not (tmp_path / "p.exr").exists()


NAME = re.compile(r".+_([0-9]+(spp)?|ref|reference|gt|target)\.(hdr|ldr|sh1[xyz]|alb|nrm)\.exr")


def test_names_and_means_of_an_image_set(tmp_path):
    rng = np.random.default_rng(2)
    samples, albedo = rng.random((5, 9, 12, 3), np.float32), rng.random((5, 9, 12, 3)).astype("f2")
    reference = rng.random((5, 9, 3), np.float32)
    spool.write(tmp_path / "box.spool", samples, albedo=albedo, reference=reference, tile_size=8)
    code, notes = run_jobs(("export oidn", tmp_path / "box.spool", tmp_path / "set"))[0]
    assert code == 0 and "no normal" in notes
    names = sorted(path.name for path in (tmp_path / "set").iterdir())
    assert all(NAME.fullmatch(name) for name in names) and len(names) == 2 * 5
    assert [name for name in names if ".hdr." in name][-1] == "box_ref.hdr.exr"
    for n in 1, 2, 4, 8:
        for suffix, layer in ("hdr", samples), ("alb", albedo):
            image = planes(tmp_path / "set" / f"box_{n:04}spp.{suffix}.exr")
            assert np.allclose(np.stack([image[c] for c in "RGB"], -1), layer[:, :, :n].astype("f8").mean(2), rtol=1e-6)
    target = planes(tmp_path / "set" / "box_ref.hdr.exr")
    assert np.array_equal(np.stack([target[c] for c in "RGB"], -1), reference)


def test_a_set_without_a_reference_is_refused(tmp_path):
    spool.write(tmp_path / "a.spool", np.ones((2, 2, 2, 3), "f4"))
    code, message = run_jobs(("export oidn", tmp_path / "a.spool", tmp_path / "set"))[0]
    assert code == 1 and "no reference from other seeds" in message
    assert not (tmp_path / "set").exists()


def test_colours_in_another_order_are_not_taken_for_rgb(tmp_path):
    samples = np.ones((4, 4, 2, 3), "f4")
    spool.write(tmp_path / "a.spool", samples, albedo=samples, reference=samples[:, :, 0], components={"albedo": "BGR"})
    spool.write(tmp_path / "b.spool", samples, reference=samples[:, :, 0], components={"reference": "BGR"})
    one, two = run_jobs(*(("export oidn", tmp_path / f"{name}.spool", tmp_path / name) for name in "ab"))
    assert one[0] == 0 and "no albedo: not recorded as RGB" in one[1] and not list((tmp_path / "a").glob("*.alb.exr"))
    assert two[0] == 1 and "no reference" in two[1]


def oidn_source(path, spp, value=1):
    spool.write(path, np.full((3, 4, spp, 3), value, "f4"), reference=np.full((3, 4, 3), value, "f4"))
    return path


@pytest.mark.parametrize("name", ["../evil", "a/b", "/evil"])
def test_the_name_of_a_set_stays_in_its_folder(tmp_path, name):
    oidn_source(tmp_path / "a.spool", 2)
    code, message = run_jobs(("export oidn", tmp_path / "a.spool", tmp_path / "out" / "in", f"name={name}"))[0]
    assert code == 2 and "has a '/'" in message and {path.name for path in tmp_path.iterdir()} == {"a.spool"}, message


def test_a_set_is_refused_before_the_first_image_and_replaced_whole(tmp_path):
    for name, spp, value in (("long", 8, 1), ("short", 2, 3)):
        oidn_source(tmp_path / f"{name}.spool", spp, value)
    out = tmp_path / "out"
    out.mkdir()
    (out / "x_0008spp.hdr.exr").write_bytes(b"of somebody")
    code, message = run_jobs(("export oidn", tmp_path / "long.spool", out, "name=x"))[0]
    assert code == 2 and "x_0008spp.hdr.exr: exists" in message and [path.name for path in out.iterdir()] == ["x_0008spp.hdr.exr"], message
    (out / "x_0008spp.hdr.exr").unlink()
    (out / "x_night_ref.hdr.exr").write_bytes(b"of another set")
    assert run_jobs(("export oidn", tmp_path / "long.spool", out, "name=x"))[0][0] == 0
    assert run_jobs(("export oidn", tmp_path / "short.spool", out, "name=x", "force=1"))[0][0] == 0
    assert sorted(path.name for path in out.iterdir()) == ["x_0001spp.hdr.exr", "x_0002spp.hdr.exr", "x_night_ref.hdr.exr", "x_ref.hdr.exr"]


@pytest.mark.parametrize("out", ["nd/", "nd/.", "nd/.exr"])
def test_statistics_have_a_name(tmp_path, out):
    (tmp_path / "nd").mkdir()
    oidn_source(tmp_path / "a.spool", 4)
    code, message = run_jobs(("export bcd-stats", tmp_path / "a.spool", f"{tmp_path}/{out}"))[0]
    assert code == 2 and "names no file" in message and not list((tmp_path / "nd").iterdir()), message
