"""Each claim of a dump is believed when it is true and refused when it is not."""
from types import SimpleNamespace

import numpy as np
import pytest

from dumps.recording import progress
import spool
from dumps.recording.failure import Failure
from dumps.verify.independence import neighbour_finding, of_few
from dumps.verify.verify import keep_verification, verify

SIZE, SPP, REFERENCE = 24, 64, 4096


def pool(seed=0, heavy=False):
    """Independent samples [y][x][s][3] with a mean and a spread that vary over the image."""
    rng = np.random.default_rng(seed)
    mean = np.linspace(0.2, 1, SIZE)[None, :, None, None]
    noise = rng.lognormal(0, 1.0 if heavy else 0.4, (SIZE, SIZE, SPP, 3))
    return (mean * noise).astype("f4")


def independent_reference(seed=99):
    mean = np.linspace(0.2, 1, SIZE)[None, :, None] * np.exp(0.4 ** 2 / 2)
    single = (np.exp(0.4 ** 2) - 1) * mean ** 2 * np.ones((SIZE, SIZE, 3))
    rng = np.random.default_rng(seed)
    return (mean + rng.standard_normal((SIZE, SIZE, 3)) * np.sqrt(single / REFERENCE)).astype("f4"), \
        (single / REFERENCE).astype("f4")


def dump(path, radiance, film=None, albedo=None, reference=None, order="exchangeable"):
    layers = {"radiance": ("f4", "RGB")}
    if albedo is not None:
        layers["albedo"] = ("f4", "RGB")
    if film is not None:
        layers["film"] = ("f4", "XY", "sample" if film.ndim == 4 else "pass")
    if reference is not None:
        layers["reference"] = layers["reference_variance"] = ("f4", "RGB", "pixel")
    with spool.Writer(path, SIZE, SIZE, SPP, layers, sample_order=order, force=True,
                      meta={"reference": {"samples": REFERENCE}}) as writer:
        arrays = {"radiance": radiance}
        if albedo is not None:
            arrays["albedo"] = albedo
        if film is not None and film.ndim == 4:
            arrays["film"] = film
        writer.write_passes(0, arrays)
        if film is not None and film.ndim == 2:
            writer.write_pass("film", film)
        if reference is not None:
            writer.write_pixel("reference", reference[0])
            writer.write_pixel("reference_variance", reference[1])
    return path


def failed(path):
    return {entry["name"] for entry in verify(str(path))["findings"] if entry["holds"] is False}


def uniform_film(seed=5):
    return np.random.default_rng(seed).random((SIZE, SIZE, SPP, 2)).astype("f4") * np.float32(0.99999)


def test_true_claims_hold(tmp_path):
    albedo = np.random.default_rng(1).random((SIZE, SIZE, SPP, 3)).astype("f4")
    path = dump(tmp_path / "good.spool", pool(), uniform_film(), albedo, independent_reference())
    assert failed(path) == set()


def test_a_sequence_is_not_exchangeable(tmp_path):
    """Stratified samples: every run of four covers the distribution."""
    ranks = np.random.default_rng(2).random((SIZE, SIZE, SPP // 4, 4)).argsort(axis=3)
    u = (ranks + np.random.default_rng(3).random(ranks.shape)) / 4
    radiance = np.repeat(u.reshape(SIZE, SIZE, SPP, 1), 3, axis=3).astype("f4")
    assert "variance of 4-means" in failed(dump(tmp_path / "sequence.spool", radiance))
    assert failed(dump(tmp_path / "said.spool", radiance, order="renderer")) == set()


def test_drift_over_the_samples_is_found(tmp_path):
    radiance = pool() * np.linspace(0.8, 1.2, SPP, dtype="f4")[None, None, :, None]
    assert {"variance of 16-means", "correlation at lag 1"} <= failed(dump(tmp_path / "drift.spool", radiance))


def test_pixels_that_share_their_noise_are_found(tmp_path):
    radiance = pool()
    radiance[:, 1::2] = radiance[:, 0::2]
    assert "neighbour correlation" in failed(dump(tmp_path / "shared.spool", radiance))


@pytest.mark.parametrize("film, name", [
    (np.full((SPP, 2), 0.5, "f4"), "no pixel-centre trap"),
    (np.random.default_rng(4).beta(4, 4, (SIZE, SIZE, SPP, 2)).astype("f4"), "film x uniform"),
    (np.random.default_rng(4).random((SPP, 2)).astype("f4") + 0.5, "film inside the pixel"),
])
def test_film_that_is_not_uniform_is_found(tmp_path, film, name):
    assert name in failed(dump(tmp_path / "film.spool", pool(), film))


def test_a_reference_of_the_same_samples_is_found(tmp_path):
    radiance = pool()
    same = radiance.astype(float).mean(axis=2).astype("f4")
    assert "reference error" in failed(
        dump(tmp_path / "same.spool", radiance, reference=(same, independent_reference()[1])))


def test_a_reference_of_another_scene_is_found(tmp_path):
    mean, variance = independent_reference()
    names = failed(dump(tmp_path / "other.spool", pool(), reference=(mean * np.float32(1.2), variance)))
    assert {"reference error", "reference energy"} <= names


@pytest.mark.parametrize("albedo, fails", [(0, set()), (0.5, {"layer depth", "layer albedo", "features vary"})])
def test_a_picture_of_the_sky_alone_has_no_features_and_fails_no_claim(tmp_path, albedo, fails):
    layers = {"radiance": pool(), "albedo": np.full((SIZE, SIZE, SPP, 3), albedo, "f4"), "depth": np.zeros((SIZE, SIZE, SPP, 1), "f4")}
    with spool.Writer(tmp_path / "sky.spool", SIZE, SIZE, SPP, {"radiance": ("f4", "RGB"), "albedo": ("f4", "RGB"), "depth": ("f4", "Z")},
                      sample_order="exchangeable") as writer:
        writer.write_passes(0, layers)
    assert failed(tmp_path / "sky.spool") == fails


def test_independent_neighbours_raise_no_alarm_where_samples_are_few():
    """The spread over few samples is known badly: by a normal distribution 21 of 400 fail."""
    rng = np.random.default_rng(6)
    found = [neighbour_finding(rng.exponential(1, (16, 16, 8, 1)) * np.ones(3), False, 0.01) for _ in range(400)]
    assert sum(entry["holds"] is False for entry in found) <= 10


@pytest.mark.parametrize("t, freedom, p", [(2.365, 7, 0.05), (3.499, 7, 0.01), (5.408, 7, 0.001), (2.947, 15, 0.01), (3.291, 10 ** 6, 0.001)])
def test_students_t(t, freedom, p):
    assert of_few(t, freedom) == pytest.approx(p, rel=0.06) and of_few(-t, freedom) == of_few(t, freedom)


def test_empty_layers_and_repeated_passes_are_found(tmp_path):
    albedo = np.zeros((SIZE, SIZE, SPP, 3), "f4")
    assert "layer albedo" in failed(dump(tmp_path / "empty.spool", pool(), albedo=albedo))
    assert "samples differ" in failed(dump(tmp_path / "seed.spool", np.repeat(pool()[:, :, :1], SPP, axis=2)))


def test_passes_all_shot_through_one_place_are_found(tmp_path):
    one = np.random.default_rng(1).random((SIZE, SIZE, 1, 3)).astype("f4")
    path = dump(tmp_path / "centre.spool", pool(), albedo=np.repeat(one, SPP, axis=2))
    assert "features vary" in failed(path)


@pytest.mark.parametrize("index, names", [(0, {"no pixel-centre trap"}), (1, set())])
def test_the_sample_index_betrays_the_pixel_centre(tmp_path, index, names):
    path = tmp_path / "index.spool"
    with spool.Writer(path, SIZE, SIZE, SPP, {"radiance": ("f4", "RGB")}, sample_order="exchangeable",
                      meta={"renderer": "Cycles", "sample_index": index}) as writer:
        writer.write_passes(0, {"radiance": pool()})
    assert failed(path) == names


def test_findings_travel_in_the_metadata_and_change_no_sample(tmp_path):
    path = dump(tmp_path / "kept.spool", pool(), uniform_film(), reference=independent_reference())
    with spool.open(path) as before:
        radiance, uuid = before.read("radiance"), before.uuid
    keep_verification(str(path), {"holds": False, "findings": []})
    before = path.read_bytes()
    keep_verification(str(path), verify(str(path)))  # in place of the first
    assert spool.check(path).ok and path.read_bytes()[:len(before) // 2] == before[:len(before) // 2]
    with spool.open(path) as after:
        assert after.meta["verification"]["holds"] is True
        assert after.meta["reference"]["samples"] == REFERENCE
        assert np.array_equal(radiance, after.read("radiance")) and uuid == after.uuid


def test_a_long_verification_says_how_far_it_is(tmp_path, monkeypatch, capsys):
    path, now = str(dump(tmp_path / "long.spool", pool(), uniform_film())), [0.0]

    def clock():
        now[0] += 25.0
        return now[0]

    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=clock))
    verify(path)
    assert capsys.readouterr().err == "verification 3 of 6, 1 min 15 s left\nverification 6 of 6, 0 s left\n"


def test_findings_are_kept_under_another_name_and_replace_nothing_unasked(tmp_path):
    path, out = dump(tmp_path / "a.spool", pool()), tmp_path / "b.spool"
    out.write_bytes(b"mine")
    with pytest.raises(Failure, match="b.spool: exists"):
        keep_verification(str(path), {"findings": []}, str(out))
    assert out.read_bytes() == b"mine" and path.exists()
    keep_verification(str(path), {"findings": []}, str(out), force=True)
    assert not path.exists() and spool.check(out).ok


@pytest.mark.parametrize("shown, named", [(0.4, "exactly black"), (0.6, None), (0.0, "exactly black")])
def test_a_picture_that_is_mostly_black_or_still_is_remarked(tmp_path, shown, named):
    radiance = pool()
    radiance[:, int(SIZE * shown):] = 0
    for name, light in (("black", radiance), ("still", np.where(radiance == 0, np.float32(0.25), radiance))):
        picture = [entry for entry in verify(str(dump(tmp_path / (name + ".spool"), light)))["findings"] if entry["name"] == "picture"]
        assert len(picture) == (named is not None)
        if named:
            assert picture[0]["holds"] is None and (named if name == "black" else "the same in every sample") in picture[0]["measured"]


@pytest.mark.parametrize("again", [lambda s: s % 40, lambda s: s - (s == 60) * 43, lambda s: s // 2])
def test_a_repeated_image_is_found_at_any_lag(tmp_path, again):
    radiance = np.random.default_rng(2).gamma(1, 1, (SIZE, SIZE, SPP, 3)).astype("f4")
    assert "images differ" not in failed(dump(tmp_path / "a.spool", radiance))
    radiance = np.ascontiguousarray(radiance[:, :, [again(s) for s in range(SPP)]])
    assert "images differ" in failed(dump(tmp_path / "b.spool", radiance))
    assert "images differ" not in failed(dump(tmp_path / "c.spool", radiance, order="renderer"))


def test_equal_images_of_a_picture_with_few_noisy_pixels_are_no_evidence(tmp_path):
    radiance = np.random.default_rng(2).random((SIZE, SIZE, 1, 3)).repeat(SPP, axis=2).astype("f4")
    radiance[0, 0] = (np.arange(SPP) % 4)[:, None]
    assert "images differ" not in failed(dump(tmp_path / "a.spool", radiance))
