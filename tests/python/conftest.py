"""Small recordings, and the program beside the package."""
import os
import subprocess

import numpy as np
import pytest

import spool

PROGRAM = os.environ["SPOOL_PROGRAM"]
LONGEST_RUN = 120 * int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))  # seconds


def made_layers(height=20, width=24, spp=16, seed=1):
    """Noise over a gradient with an edge, with every layer that a method may want."""
    random = np.random.default_rng(seed)
    mean = np.linspace(0.2, 1.0, width)[None, :] * np.where(np.arange(height) < height // 2, 1, 3)[:, None]
    rgb = mean[:, :, None] * (1.0, 0.8, 0.6)
    shape = height, width, spp
    return {"radiance": (rgb[:, :, None, :] * random.exponential(1.0, (*shape, 3))).astype("f4"),
            "film": random.random((*shape, 2), "f4"),
            "albedo": np.repeat(rgb[:, :, None, :], spp, axis=2).astype("f4"),
            "normal": random.normal(size=(*shape, 3)).astype("f4"),
            "depth": np.repeat(mean[:, :, None, None], spp, axis=2).astype("f4"),
            "reference": rgb.astype("f4"), "reference_variance": np.full_like(rgb, 1e-6, dtype="f4")}


@pytest.fixture
def layers():
    return made_layers()


@pytest.fixture
def path(tmp_path, layers):
    spool.write(tmp_path / "scene.spool", sample_order="exchangeable", tile_size=16, block_spp=8, **layers)
    return tmp_path / "scene.spool"


@pytest.fixture
def dump(path):
    with spool.open(path) as opened:
        yield opened


@pytest.fixture
def program(tmp_path):
    """Runs the program; its last line of stderr, after its exit code."""
    def run(*words):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=tmp_path, text=True, capture_output=True,
                              timeout=LONGEST_RUN)
        return done.returncode, done.stderr.strip().removeprefix("spool: ")
    run.folder = tmp_path
    return run
