"""Short references: sound recordings raise no alarm, wrong references are found."""
from types import SimpleNamespace

import numpy as np
import pytest

from dumps.verify.reference_agreement import reference_findings

LEVEL, SIZE, SAMPLES, SHORT = 1e-3, 48, 64, 64


def scene(rng):
    return np.repeat(rng.uniform(0.02, 0.5, (SIZE, SIZE, 1)), 3, axis=2)


def draw(rng, truth, count):
    """Skewed samples of mean `truth`, as grey light: [y][x][sample][channel]."""
    return truth[:, :, None, :] * rng.gamma(0.2, 5.0, (*truth.shape[:2], count, 1))


def fails(rng, truth, of_reference):
    samples = draw(rng, of_reference, SHORT)
    layers = {"reference": samples.mean(axis=2), "reference_variance": samples.var(axis=2, ddof=1) / SHORT}
    dump = SimpleNamespace(layers=layers, pixel=layers.get, sample_order="exchangeable", meta={})
    found = reference_findings(dump, draw(rng, truth, SAMPLES), LEVEL)
    return any(entry["holds"] is False for entry in found)


def test_sound_recordings_raise_no_alarm():
    rng = np.random.default_rng(11)
    assert sum(fails(rng, truth, truth) for truth in (scene(rng) for _ in range(40))) <= 2


def sound_ones(count, height, width, channels=1, seed=13, level=LEVEL):
    """Names of the claims that fail in sound recordings of this size; channels: 1: grey light, 3: channels of their own."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(count):
        truth = rng.uniform(0.1, 1, (height, width, 1)) * np.ones(3)
        pool, samples = (truth[:, :, None] * rng.exponential(1, (height, width, n, channels)) for n in (12, 128))
        layers = {"reference": samples.mean(axis=2), "reference_variance": samples.var(axis=2, ddof=1) / 128}
        dump = SimpleNamespace(layers=layers, pixel=layers.get, sample_order="exchangeable", meta={"reference": {"samples": 128}})
        found += [entry["name"] for entry in reference_findings(dump, pool, level) if entry["holds"] is False]
    return found


@pytest.mark.parametrize("height, width", [(1, 1), (1, 7), (8, 8), (8, 16), (16, 16)])
def test_small_pictures_raise_no_alarm(height, width):
    """A spread over few blocks is known badly, over one not at all."""
    assert sound_ones(100, height, width, level=1e-4).count("reference error") <= 1


@pytest.mark.parametrize("channels", [1, 3])
def test_grey_light_raises_no_more_alarms_of_energy_than_coloured_light(channels):
    assert sound_ones(600, 16, 16, channels, level=0.02).count("reference energy") <= 25      # 12 by chance


def test_a_wrong_reference_of_a_small_picture_is_found():
    rng = np.random.default_rng(14)
    truth = scene(rng)[:16, :16]
    assert fails(rng, truth, 2 * truth) and fails(rng, truth, truth[::-1])


def test_wrong_references_are_found():
    rng = np.random.default_rng(12)
    truth = scene(rng)
    smooth = sum(np.roll(truth, (y, x), (0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1)) / 9
    for wrong in (scene(rng), smooth, np.roll(truth, 1, axis=1), 1.1 * truth):
        assert fails(rng, truth, wrong)


def test_the_mean_of_the_samples_themselves_is_found():
    rng = np.random.default_rng(13)
    truth = scene(rng)
    samples = draw(rng, truth, SAMPLES).astype("f4")
    for reference, own in ((samples.mean(axis=2), True), (samples[:, :, 1:].mean(axis=2), False), (draw(rng, truth, SHORT).mean(axis=2), False)):
        dump = SimpleNamespace(layers={"reference": reference}, pixel={"reference": reference}.get, sample_order="renderer", meta={})
        assert [entry["holds"] for entry in reference_findings(dump, samples, LEVEL)] == [False if own else None]


@pytest.mark.parametrize("harm, words", [(lambda r: r, ""), (lambda r: r[::-1], "upside down"), (lambda r: 2 * r, "2 times the light"),
                                         (lambda r: 0 * r, "0 times the light"),
                                         (lambda r: np.roll(r, 5, 1), "times the light")])
def test_a_reference_without_a_variance_is_of_the_same_picture(harm, words):
    rng = np.random.default_rng(14)
    truth = scene(rng)
    layers = {"reference": harm(draw(rng, truth, 1024).mean(axis=2))}
    dump = SimpleNamespace(layers=layers, pixel=layers.get, sample_order="renderer", meta={})
    found = reference_findings(dump, draw(rng, truth, SAMPLES), LEVEL)
    assert [entry["holds"] for entry in found] == [False if words else None] and words in str(found)
