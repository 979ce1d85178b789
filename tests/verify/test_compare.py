"""Two recordings of one scene: what agrees and what does not is told in figures."""
import numpy as np
import pytest

from dumps.recording.failure import Failure
from dumps.verify import compare
import spool

SIZE, SPP = 32, 16


def recording(path, mean=0.5, noise=0.1, size=SIZE, seed=1, reference=True):
    rng = np.random.default_rng(seed)
    layers = {"radiance": ("f4", "RGB")}
    if reference:
        layers["reference"] = layers["reference_variance"] = ("f4", "RGB", "pixel")
    with spool.Writer(path, size, size, SPP, layers, sample_order="exchangeable",
                      meta={"cost_per_sample": 1e-6 * seed}) as writer:
        writer.write_passes(0, {"radiance": (mean + noise * rng.standard_normal((size, size, SPP, 1)) * np.ones(3)).astype("f4")})
        if reference:
            error = noise / 64
            grey = mean + error * rng.standard_normal((size, size, 1)) * np.ones(3)
            writer.write_pixel("reference", grey.astype("f4"))
            writer.write_pixel("reference_variance", np.full((size, size, 3), error ** 2, "f4"))
    return str(path)


def test_equal_scenes_agree_and_noise_and_cost_are_told(tmp_path):
    found = compare.compare(recording(tmp_path / "a"), recording(tmp_path / "b", noise=0.2, seed=2))
    assert abs(found["energy_ratio"] - 1) < 4 * found["energy_ratio_error"] < 0.001
    assert found["blocks_within_3_sigma_or_2_percent"] == 1
    assert found["sample_variance"][1] / found["sample_variance"][0] == pytest.approx(4, rel=0.1)
    assert found["variance_times_cost"][1] / found["variance_times_cost"][0] == pytest.approx(8, rel=0.1)


def test_a_brighter_scene_is_told(tmp_path):
    found = compare.compare(recording(tmp_path / "a"), recording(tmp_path / "b", mean=0.6, seed=2))
    assert found["energy_ratio"] == pytest.approx(1.2, abs=0.01)
    assert found["block_difference_median"] == pytest.approx(0.2, abs=0.01)
    assert found["blocks_within_3_sigma_or_2_percent"] == 0


def test_the_error_of_the_energy_is_that_of_grey_light(tmp_path):
    """Its channels are off together: sqrt(2) * error / sqrt(pixels)."""
    found = compare.compare(recording(tmp_path / "a"), recording(tmp_path / "b", seed=2))
    assert found["energy_ratio_error"] == pytest.approx(2 ** 0.5 * 0.1 / 64 / 0.5 / SIZE, rel=0.05)


def test_pictures_smaller_than_a_block_are_compared(tmp_path):
    found = compare.compare(recording(tmp_path / "a", size=3), recording(tmp_path / "b", size=3, seed=2))
    assert (found["blocks"], found["block_side"]) == (1, 3)
    assert "blocks of 3x3 pixels" in "\n".join(compare.told(("a", "b"), found))


@pytest.mark.parametrize("other, words", [({"size": 16}, "record both at one size"), ({"reference": False}, "no reference")])
def test_what_cannot_be_compared_is_refused(tmp_path, other, words):
    with pytest.raises(Failure, match=words):
        compare.compare(recording(tmp_path / "a"), recording(tmp_path / "b", **other))
