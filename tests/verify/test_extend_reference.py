"""A finished recording takes another reference into its own."""
import os
import subprocess
import sys

import numpy as np
import pytest

import spool
from conftest import ROOT

EXTEND = os.path.join(ROOT, "dumps", "extend_reference.py")
SHAPE = (16, 24, 3)


def recorded(path, samples, seed, scene="a" * 64, width=24, spp=16):
    """A recording of noise; its reference is the mean of `samples`, with the variance that they show."""
    random = np.random.default_rng(seed)
    drawn = random.exponential(1.0, (16, width, samples, 3))
    meta = {"scene": {"sha256": scene}, "renderer": "none", "settings": {"depth": seed and 4}, "seeds": {"user": seed},
            "reference": {"samples": samples, "samples_least": samples, "samples_most": samples, "independent": True}}
    layers = {"radiance": ("f2", "RGB"), "reference": ("f4", "RGB", "pixel"), "reference_variance": ("f4", "RGB", "pixel")}
    with spool.Writer(path, width, 16, spp, layers, block_spp=4, sample_order="exchangeable", meta=meta, compress=True) as writer:
        writer.write_passes(0, {"radiance": random.exponential(1.0, (16, width, spp, 3)).astype("f2")})
        writer.write_pixel("reference", drawn.mean(axis=2).astype("f4"))
        writer.write_pixel("reference_variance", (drawn.var(axis=2, ddof=1) / samples).astype("f4"))
    return drawn


def extend(*arguments):
    return subprocess.run([sys.executable, EXTEND, *map(str, arguments)], capture_output=True, text=True)


def test_the_mean_of_all_samples_and_its_variance(tmp_path):
    path, more = tmp_path / "a.spool", tmp_path / "b.spool"
    drawn = np.concatenate([recorded(path, 512, 1), recorded(more, 1024, 2)], axis=2)
    with spool.open(path) as dump:
        before = dump.read("radiance").copy()
    done = extend(path, more)
    assert done.returncode == 0 and "a reference of 1536 samples" in done.stdout, done.stdout + done.stderr
    with spool.open(path) as dump:
        np.testing.assert_allclose(dump.pixel("reference"), drawn.mean(axis=2), rtol=1e-6)
        variance = drawn.var(axis=2, ddof=1) / 1536
        assert abs(dump.pixel("reference_variance").mean() / variance.mean() - 1) < 0.01
        assert np.array_equal(dump.read("radiance"), before)
        assert dump.meta["reference"]["samples"] == 1536 and dump.meta["reference"]["seeds"] == [1, 2]
        assert dump.meta["verification"]["holds"] is True
    assert sorted(os.listdir(tmp_path)) == ["a.spool", "b.spool"]
    again = extend(path, more)          # its samples are in there already
    assert again.returncode == 1 and "has samples of seed 2" in again.stderr and again.stderr.count("\n") == 1


@pytest.mark.parametrize("other, words", [({"scene": "b" * 64}, "scene.sha256 differs"), ({"width": 16}, "16x16"),
                                          ({"seed": 0}, "settings differs"), ({"seed": 1}, "another --seed")])
def test_another_scene_size_or_the_same_seed_is_one_line_and_nothing_changes(tmp_path, other, words):
    path, more = tmp_path / "a.spool", tmp_path / "b.spool"
    recorded(path, 16, 1)
    recorded(more, 16, **{"seed": 2, **other})
    content = path.read_bytes()
    done = extend(path, more)
    assert done.returncode == 1 and words in done.stderr and done.stderr.count("\n") == 1 and path.read_bytes() == content


def test_what_is_missing_or_damaged_is_one_short_line(tmp_path):
    path = tmp_path / "a.spool"
    recorded(path, 16, 1)
    (tmp_path / "cut.spool").write_bytes(path.read_bytes()[:2000])
    for other, code in (("nowhere.spool", 3), ("cut.spool", 4), ("n" * 3000, 3)):
        done = extend(path, tmp_path / other)
        assert done.returncode == code and done.stderr.count("\n") == 1 and len(done.stderr) <= 401, done.stderr
