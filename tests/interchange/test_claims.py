"""Samples that are not what a dump claims of them, in folders and arrays alike; features in another convention; references of another picture."""
import json
import warnings

import numpy as np
import pytest
import spool

from conftest import run_jobs
from test_exr_folder import folder

RNG = np.random.default_rng(34)
HEIGHT, WIDTH, SPP = 12, 13, 16
LIGHT = RNG.gamma(0.5, 1, (HEIGHT, WIDTH, SPP, 3)).astype("f4")
HALF = LIGHT[:, :, :SPP // 2]


def stopped(fill):
    """Pixels that hold one value from a sample of their own on, some to the end."""
    light, last = LIGHT.copy(), RNG.integers(4, SPP + 1, (HEIGHT, WIDTH))
    for y, x in np.ndindex(HEIGHT, WIDTH):
        light[y, x, last[y, x]:] = light[y, x, last[y, x] - 1] if fill is None else fill
    return light


def wrapped():
    """Pixels that repeat their samples from a number of their own on."""
    light, last = LIGHT.copy(), np.random.default_rng(37).integers(4, SPP - 1, (HEIGHT, WIDTH))
    for y, x in np.ndindex(HEIGHT, WIDTH):
        light[y, x] = LIGHT[y, x, np.arange(SPP) % last[y, x]]
    return light


def means(light):
    return (np.cumsum(light, 2) / np.arange(1, light.shape[2] + 1)[:, None]).astype("f4")


LONG = np.random.default_rng(35).gamma(0.5, 1, (HEIGHT, WIDTH, 32, 3)).astype("f4")


def smoothed(keep):
    """An image keeps a share of the one before it, as with temporal filters."""
    light = LONG.copy()
    for s in range(1, light.shape[2]):
        light[:, :, s] = keep * light[:, :, s - 1] + (1 - keep) * LONG[:, :, s]
    return light


WRONG = {
    "a seed again": (np.concatenate([HALF, HALF], 2), "image 8 is image 0 again, 8 of 16"),
    "each image twice": (np.repeat(HALF, 2, 2), "image 1 is image 0 again, 8 of 16"),
    "one image again": (np.concatenate([LIGHT[:, :, :15], LIGHT[:, :, 4:5]], 2), "image 15 is image 4 again, 1 of 16"),
    "again, rounded": (np.concatenate([HALF, HALF.astype("f2").astype("f4")], 2), "image 8 is almost image 0 again"),
    "one image": (np.repeat(LIGHT[:, :, :1], 4, 2), "all 4 images are alike"),
    "running means": (means(LIGHT), "running means"),
    "few running means": (means(HALF), "running means"),
    "running sums": (np.cumsum(LIGHT, 2), "running means or sums"),
    "held": (stopped(None), "adaptive"), "black": (stopped(0), "adaptive"), "not a number": (stopped(np.nan), "adaptive"),
    "padded by its own samples": (wrapped(), "begin again"),
    "smoothed in time": (smoothed(0.5), "like the one before it"),
    "means of two": (LONG + np.roll(LONG, 1, 2), "like the one before it"),
    "brighter": (RNG.random((HEIGHT, WIDTH, 32, 3)) * (1 + 0.1 * np.arange(32))[:, None], "brighter"),
}


def packed(tmp_path, light, *options, form="npz"):
    light = np.asarray(light, "f4")
    if form == "npz":
        source = tmp_path / "a.npz"
        np.savez(source, radiance=light)
        options = ("layout=HWSC", *options)
    else:
        source = folder(tmp_path, "RGB", list(light.transpose(2, 0, 1, 3)))
    return run_jobs((f"import {form}", source, tmp_path / "a.spool", *options))[0]


@pytest.mark.parametrize("kind", WRONG)
def test_samples_that_are_not_exchangeable_are_refused_where_that_is_claimed(tmp_path, kind):
    light, reason = WRONG[kind]
    code, message = packed(tmp_path, light, "exchangeable=on", "tile=8" if kind == "held" else "block=3")
    assert code == 1 and reason in message and "not exchangeable" in message, message
    assert not list(tmp_path.glob("*.spool*"))
    code, message = packed(tmp_path, light)
    assert code == 0 and reason in message and "not independent" in message, message
    with spool.open(tmp_path / "a.spool") as dump:
        assert reason in dump.meta["import_remarks"][0]


@pytest.mark.parametrize("kind", ["a seed again", "running means", "held"])
def test_folders_are_judged_alike(tmp_path, kind):
    code, message = packed(tmp_path, WRONG[kind][0], "exchangeable=on", form="exr-folder")
    assert code == 1 and WRONG[kind][1] in message, message


@pytest.mark.parametrize("seed", range(40))
def test_independent_samples_pass(tmp_path, seed):
    rng = np.random.default_rng(seed)
    height, width, spp = (int(n) for n in rng.integers(1, 30, 3))
    shape = (height, width, spp, 1)
    light = [rng.gamma(0.05, 1, shape), rng.pareto(1, shape), rng.random(shape) < 0.02, np.full(shape, 0.5),
             rng.random(shape) * (rng.random((1, 1, spp, 1)) < 0.5)][seed % 5] * np.ones(3)
    code, message = packed(tmp_path, light, "exchangeable=on")
    assert (code, message) == (0, ""), message


def test_images_beyond_the_watched_pixels_are_found(tmp_path):
    rng = np.random.default_rng(1)
    light = rng.random((4, 400, 300, 3), np.float32)
    light[3] = light[1]
    np.savez(tmp_path / "a.npz", radiance=light)
    code, message = run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=SHWC", "exchangeable=on"))[0]
    assert code == 1 and "image 3 is image 1 again, 1 of 4" in message, message


def unit(shape):
    v = RNG.standard_normal(shape + (3,))
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


SHAPE = (20, 20, 4)
FACING = unit(SHAPE)
FACING[..., 2] = np.abs(FACING[..., 2]) + 0.1
FACING /= np.linalg.norm(FACING, axis=-1, keepdims=True)
MISSED = np.where(RNG.random(SHAPE + (1,)) < 0.2, 0, unit(SHAPE))
PLACES = RNG.random(SHAPE + (3,)) * 10
CONVENTIONS = {
    "encoded normals": ({"normal": MISSED / 2 + 0.5}, "normal: encoded as n / 2 + 1 / 2"),
    "encoded in bytes": ({"normal": np.rint((unit(SHAPE) / 2 + 0.5) * 255)}, "normal: encoded in 8 bits"),
    "long normals": ({"normal_geo": 3 * unit(SHAPE)}, "normal_geo: 100 % have another length than 1 (3 to 3)"),
    "camera space": ({"normal": FACING}, "normal: Z is above 0 in 100 % of them, as in camera space"),
    "percent": ({"albedo": np.full(SHAPE + (3,), 96)}, "albedo: 100 % of the values are above 1, the largest 96"),
    "negative albedo": ({"albedo": RNG.random(SHAPE + (3,)) - 0.1}, "albedo: "),
    "negative depth": ({"depth": -RNG.random(SHAPE)}, "depth: 100 % of the values are below 0"),
    "far": ({"depth": np.where(RNG.random(SHAPE) < 0.5, 1e10, 3)}, "where nothing is hit, 0 is expected"),
    "depth buffer": ({"depth": 1 - RNG.random(SHAPE) / 10}, "of a depth buffer?"),
    "bytes": ({"radiance": np.random.default_rng(36).integers(0, 256, SHAPE + (3,))}, "radiance: all values are whole numbers up to 255"),
    "bytes as floats": ({"radiance": np.random.default_rng(36).integers(0, 256, SHAPE + (3,)) / 255}, "radiance: all values are multiples of 1 / 255"),
    "places in the picture": ({"film": RNG.random(SHAPE + (2,)) * 20}, "film: from "),
    "places from the middle": ({"film": RNG.random(SHAPE + (2,)) - 0.5}, "film: from -0."),
    "units": ({"depth": 1000 * PLACES[..., 0], "position": PLACES}, "depth: spans 1e+04 where position spans 17"),
}


@pytest.mark.parametrize("kind", CONVENTIONS)
def test_features_in_another_convention_are_named(tmp_path, kind):
    layers, remark = CONVENTIONS[kind]
    layers = {"radiance": RNG.random(SHAPE + (3,))} | layers
    np.savez(tmp_path / "a.npz", **{k: v.astype("f4") for k, v in layers.items()})
    code, message = run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC"))[0]
    assert code == 0 and remark in message and message.count(";") == 1, message
    with spool.open(tmp_path / "a.spool") as dump:
        assert remark in dump.meta["import_remarks"][0]


def test_places_of_passes_are_looked_at(tmp_path):
    for places, remarks in ((RNG.random((SHAPE[2], 2)), []), (RNG.random((SHAPE[2], 2)) * 20, ["film: from "])):
        np.savez(tmp_path / "a.npz", radiance=RNG.random(SHAPE + (3,)).astype("f4"), film=places.astype("f4"),
                 meta=json.dumps({"scope": {"film": "pass"}}))
        code, message = run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC", "force"))[0]
        assert code == 0 and all(remark in message for remark in remarks) and bool(message) == bool(remarks), message


def test_features_as_the_format_has_them_are_not_remarked(tmp_path):
    arrays = {"radiance": RNG.random(SHAPE + (3,)), "normal": MISSED, "albedo": RNG.random(SHAPE + (3,)), "position": PLACES,
              "depth": np.where(RNG.random(SHAPE) < 0.2, 0, PLACES[..., 2] + 1), "film": RNG.integers(0, 64, SHAPE + (2,)) / 64}
    for dtype in ("f4", "f2"):
        np.savez(tmp_path / "a.npz", **{name: values.astype(dtype) for name, values in arrays.items()})
        assert run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC", "force"))[0] == (0, "")


def test_an_albedo_that_is_not_finite_is_not_above_1(tmp_path):
    albedo = RNG.random(SHAPE + (3,)).astype("f4")
    albedo[0, 0, 0] = np.inf
    np.savez(tmp_path / "a.npz", radiance=RNG.random(SHAPE + (3,)).astype("f4"), albedo=albedo)
    code, message = run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC"))[0]
    assert code == 0 and "not finite" in message and "above 1" not in message, message


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_judges_with_which_no_verb_opens_a_recording_are_refused(tmp_path, value):
    reference, variance = RNG.random(SHAPE[:2] + (3,)).astype("f4"), np.zeros(SHAPE[:2] + (3,), "f4")
    variance[2, 1, 1] = value
    light = RNG.random(SHAPE + (3,)).astype("f4")

    def packed(**judges):
        np.savez(tmp_path / "a.npz", radiance=light, **judges)
        return run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC", "force"))[0]

    code, message = packed(reference=reference, reference_variance=variance)
    assert code == 1 and "a.npz: reference_variance of pixel 1,2 is not finite" in message, message
    code, message = packed(reference=reference + np.float32(value))
    assert code == 1 and "a.npz: reference: no value is finite" in message, message
    assert not (tmp_path / "a.spool").exists()
    reference[2, 1, 1] = np.nan                  # which judges nothing there
    assert packed(reference=reference, reference_variance=variance)[0] == 0


# A picture without symmetry, 64 x 64 pixels and 8 samples, and a reference of other samples.
PICTURE = np.random.default_rng(38).gamma(1, 1, (8, 8, 1, 3)).repeat(8, 0).repeat(8, 1) * np.linspace(0.2, 1, 64)[:, None, None, None]
NOISY = (PICTURE * np.random.default_rng(39).exponential(1, (64, 64, 8, 3))).astype("f4")
JUDGE = (PICTURE * np.random.default_rng(40).gamma(256, 1 / 256, (64, 64, 1, 3)))[:, :, 0].astype("f4")
OTHER = {
    "upside down": (JUDGE[::-1], "upside down"), "mirrored": (JUDGE[:, ::-1], "mirrored"),
    "turned": (JUDGE[::-1, ::-1], "turned by 180 degrees"), "transposed": (JUDGE.transpose(1, 0, 2), "with x and y exchanged"),
    "BGR": (JUDGE[..., ::-1], "the samples with red and blue exchanged"),
    "BGR upside down": (JUDGE[::-1, :, ::-1], "upside down and with red and blue exchanged"),
    "exposure": (2 * JUDGE, "has 2 times the light"), "encoded": (JUDGE.clip(0, 1) ** (1 / 2.2), "times the light"),
    "black": (0 * JUDGE, "has 0 times the light"),
    "another frame": (np.roll(JUDGE, 11, 1), "times the light"), "tone-mapped": (JUDGE / (1 + JUDGE), "times the light"), "clamped": (JUDGE.clip(0, 1), "times the light"),
}


def judged(tmp_path, light, reference, *options):
    np.savez(tmp_path / "a.npz", radiance=light, reference=np.ascontiguousarray(reference))
    return run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC", "force", *options))[0]


@pytest.mark.parametrize("kind", OTHER)
def test_a_reference_of_another_picture_is_named(tmp_path, kind):
    reference, remark = OTHER[kind]
    for light, options in ((NOISY, ()), (NOISY.astype("f2"), ("tile=16", "block=3"))):
        code, message = judged(tmp_path, light, reference.astype(light.dtype), *options)
        assert code == 0 and message.startswith("reference: ") and remark in message and message.count(";") == 1, message
        with spool.open(tmp_path / "a.spool") as dump:
            assert remark in dump.meta["import_remarks"][0]
        with pytest.warns(UserWarning) as warned:
            spool.write(tmp_path / "b.spool", light, reference=reference.astype(light.dtype), force=True)
        assert str(warned[0].message) == f"{tmp_path / 'b.spool'}: " + message.removesuffix("; ").replace("reference: ", "the reference ")


def test_a_reference_of_the_same_picture_is_not_remarked(tmp_path):
    rare = np.where(np.random.default_rng(41).random((64, 64, 8, 3)) < 0.002, 500 * NOISY, 0)
    few = NOISY[:, :, :1]
    gaps = np.where(np.random.default_rng(42).random((64, 64, 1, 1)) < 0.1, np.nan, NOISY)
    for light, reference in ((NOISY, JUDGE), (few, JUDGE), (rare, JUDGE), (NOISY[:15, :15], 2 * JUDGE[:15, :15]),
                             (NOISY, np.where(JUDGE > 2, np.inf, JUDGE)), (gaps, JUDGE), (0 * NOISY, 0 * JUDGE)):
        code, message = judged(tmp_path, light.astype("f4"), reference.astype("f4"))
        assert code == 0 and "reference" not in message, message
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", UserWarning)
            spool.write(tmp_path / "b.spool", light.astype("f4"), reference=reference.astype("f4"), force=True)
        assert [str(w.message) for w in warned if "the reference" in str(w.message)] == []


def test_a_large_picture_is_judged_by_a_part_of_its_pixels(tmp_path):
    light, reference = NOISY[:, :, :2].repeat(3, 0).repeat(3, 1), JUDGE.repeat(3, 0).repeat(3, 1)
    assert judged(tmp_path, light, reference) == (0, "")
    assert "mirrored" in judged(tmp_path, light, reference[:, ::-1])[1]
