"""Short references: sound recordings raise no alarm, wrong references are found."""
from types import SimpleNamespace

import numpy as np

from dumps.verify.reference_agreement import reference_findings

LEVEL, SIZE, SAMPLES, SHORT = 1e-3, 48, 64, 64


def scene(rng):
    return np.repeat(rng.uniform(0.02, 0.5, (SIZE, SIZE, 1)), 3, axis=2)


def draw(rng, truth, count):
    """Skewed samples of mean `truth`, as grey light: [y][x][sample][channel]."""
    return truth[:, :, None, :] * rng.gamma(0.2, 5.0, (SIZE, SIZE, count, 1))


def fails(rng, truth, of_reference):
    samples = draw(rng, of_reference, SHORT)
    layers = {"reference": samples.mean(axis=2), "reference_variance": samples.var(axis=2, ddof=1) / SHORT}
    dump = SimpleNamespace(layers=layers, pixel=layers.get, sample_order="exchangeable", meta={})
    found = reference_findings(dump, draw(rng, truth, SAMPLES), LEVEL)
    return any(entry["holds"] is False for entry in found)


def test_sound_recordings_raise_no_alarm():
    rng = np.random.default_rng(11)
    assert sum(fails(rng, truth, truth) for truth in (scene(rng) for _ in range(40))) <= 2


def test_wrong_references_are_found():
    rng = np.random.default_rng(12)
    truth = scene(rng)
    smooth = sum(np.roll(truth, (y, x), (0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1)) / 9
    for wrong in (scene(rng), smooth, np.roll(truth, 1, axis=1), 1.1 * truth):
        assert fails(rng, truth, wrong)
