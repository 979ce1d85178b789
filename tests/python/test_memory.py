"""A mapped recording is not copied, nor is an array that lies as the library reads it."""
import os
import re
import subprocess
import sys

import numpy as np

import spool

# Private memory: what a copy would be. Pages of a mapped file are shared.
MEASURE = """
import re, sys, spool
def private():
    text = open("/proc/self/smaps_rollup").read()
    return sum(int(re.search(rf"^{name}: +(\\d+)", text, re.M)[1]) for name in ("Private_Dirty", "Anonymous")) // 2 * 1024
spool.replay(spool.synth("slanted_edge", width=16, height=16, spp=4), "uniform", 2)  # what is taken once
dump = spool.open(sys.argv[1])
before = private()
chosen = spool.replay(dump, "uniform", 4)
image = spool.reconstruct(dump, chosen, "box")
print(private() - before, chosen.counts.size)
"""


def test_a_mapped_file(tmp_path):
    side = int(os.environ.get("SPOOL_PYTHON_MEMORY_SIDE", "256"))  # 1672: 2 GB
    spp = 64
    path = tmp_path / "large.spool"
    spool.synth("slanted_edge", width=side, height=side, spp=spp, path=path)
    done = subprocess.run([sys.executable, "-c", MEASURE, path], check=True, capture_output=True, text=True)
    taken, pixels = map(int, done.stdout.split())
    size = path.stat().st_size
    assert size > 12 * spp * side * side
    # Statistics, selection and image are some 300 bytes a pixel; the samples are 768.
    assert taken < 400 * pixels + 8e6 < 0.75 * size + 8e6, (taken, size)


def test_an_array_that_lies_right():
    planes = np.random.default_rng(1).random((3, 64, 64, 16), np.float32)  # [c][y][x][s]
    recording = spool.recording(np.moveaxis(planes, 0, 3))
    before = spool.replay(recording, "uniform", 16).image
    planes *= 2  # seen through the recording: it is the same memory
    assert np.allclose(spool.replay(recording, "uniform", 16).image, 2 * before)
    assert not np.allclose(before, 2 * before)


def test_a_view_outlives_what_it_came_from():
    def image():
        samples = np.ones((8, 8, 4, 3), np.float32)
        return spool.replay(spool.recording(samples), "uniform", 4).image
    assert (image() == 1).all() and re.match(r"\d", spool.__version__)
