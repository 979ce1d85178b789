"""Every sampler with every filter: the package, the program and a C++ program on the library make the same image."""
import os
import subprocess

import numpy as np
import pytest

import spool
from spool import exr

SAMPLERS = [name for name, one in spool.samplers().items() if not one["argument"]]
FILTERS = [name for name, one in spool.filters().items() if not one["argument"] and name != "oidn"]
IN_LOOP = ("filtered_halves", "cross_halves")


def pixels(path):
    image = exr.read(path)
    return np.stack([image[c] for c in "RGB"], axis=-1)


@pytest.fixture(scope="module")
def by_the_library(tmp_path_factory):
    """The recording and the folder of the C++ program's images."""
    from conftest import made_layers
    folder = tmp_path_factory.mktemp("pairs")
    spool.write(folder / "scene.spool", sample_order="exchangeable", tile_size=16, block_spp=8, **made_layers())
    subprocess.run([os.environ["SPOOL_EVERY_PAIR"], folder / "scene.spool", folder], check=True)
    return folder


def test_there_is_an_image_of_every_pair(by_the_library):
    assert len(list(by_the_library.glob("*.exr"))) == len(SAMPLERS) * len(FILTERS) >= 120


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_the_pairs_of(sampler, by_the_library, program):
    text = f"{sampler}{{filter=box}}" if sampler in IN_LOOP else sampler
    path = by_the_library / "scene.spool"
    code, error = program("replay", path, "--sampler", text, "--spp", "6", "-o", "n.exr")
    assert code == 0, error
    with spool.open(path) as dump:
        chosen = spool.replay(dump, text, 6)
        for name in FILTERS:
            code, error = program("reconstruct", path, "--selection", "n.exr", "--filter", name, "-o", f"{name}.exr")
            assert code == 0, error
            expected = pixels(by_the_library / f"{sampler}.{name}.exr")
            assert expected.std() > 0.1
            np.testing.assert_array_equal(spool.reconstruct(dump, chosen, name).astype("f4"), expected, name)
            np.testing.assert_array_equal(pixels(program.folder / f"{name}.exr"), expected, name)
