"""Starts the program and makes small dumps for it."""
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

import spool

PROGRAM = os.environ["SPOOL_PROGRAM"]
LONGEST_RUN = 120 * int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))  # seconds; sanitizers have a factor


# Where Open Image Denoise is not: a library that has its functions, for plans that are read and judged but not run.
OIDN = os.environ.get("SPOOL_OIDN") or str(Path(PROGRAM).resolve().parent / "tests/filters/liboidn_stub_2.so")
WITH_OIDN = {**os.environ, "SPOOL_OIDN": OIDN}


class Finished:
    """What a run of the program left: exit code, output, the single line of its error."""

    def __init__(self, process):
        self.code, self.out, self.err = process.returncode, process.stdout, process.stderr

    @property
    def json(self):
        return json.loads(self.out)

    def failed_with(self, code, *words):
        """Wants this exit code and one line on stderr that holds all words."""
        lines = [line for line in self.err.splitlines() if "warning:" not in line]
        assert self.code == code, (self.code, self.out, self.err)
        assert len(lines) == 1, self.err
        for word in words:
            assert str(word) in lines[0], (word, lines[0])


@pytest.fixture
def run(tmp_path):
    def run_program(*arguments, **options):
        return Finished(subprocess.run([PROGRAM, *map(str, arguments)], cwd=tmp_path, text=True,
                                       capture_output=True, timeout=LONGEST_RUN, **options))
    return run_program


@pytest.fixture
def good(run):
    def run_good(*arguments):
        finished = run(*arguments)
        assert finished.code == 0, (finished.out, finished.err)
        return finished
    return run_good


def samples(height=20, width=24, spp=16, seed=1):
    """Noise over a gradient with an edge: [y][x][s][c], float32."""
    random = np.random.default_rng(seed)
    mean = np.linspace(0.2, 1.0, width)[None, :] * np.where(np.arange(height) < height // 2, 1, 3)[:, None]
    noise = random.exponential(1.0, (height, width, spp, 3))
    return (mean[:, :, None, None] * noise).astype("<f4"), mean


def write_dump(path, radiance, **layers):
    spool.write(path, radiance=radiance, sample_order="exchangeable", tile_size=16, block_spp=8,
                **layers)
    return path


@pytest.fixture
def dump(tmp_path):
    radiance, mean = samples()
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    return write_dump(tmp_path / "scene.spool", radiance, reference=reference,
                      reference_variance=np.zeros_like(reference),
                      meta={"renderer": {"name": "numpy", "version": np.__version__},
                            "cost_per_sample": 2e-6})


def read_exr(path, channel):
    """One channel as float64 [y][x]."""
    image = OpenImageIO.ImageInput.open(str(path))
    pixels = image.read_image("double")
    place = image.spec().channelnames.index(channel)
    # OpenImageIO maps integers to 0..1.
    scale = 2**32 - 1 if image.spec().channelformat(place) == OpenImageIO.TypeDesc("uint") else 1
    image.close()
    return np.rint(pixels[:, :, place] * scale) if scale > 1 else pixels[:, :, place]
