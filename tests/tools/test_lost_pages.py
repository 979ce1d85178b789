"""A recording that is cut while the program has it mapped: one line and exit code 4; in a batch the cells fail, not the run.

An `exec:` sampler cuts the file at the moment when it is asked, so that nothing depends on time."""
import sys
from pathlib import Path

import numpy as np
import pytest

from conftest import samples, write_dump
from results_comparison import rows_of

CUTTER = """import os, sys, numpy as np
from spool import exr
image = exr.read(sys.argv[1])
height, width = next(iter(image.values())).shape
os.truncate({dump!r}, {size})
exr.write(sys.argv[2], {{"n": np.full((height, width), 4, "f4")}})
"""


@pytest.fixture
def cutter(tmp_path):
    """A recording of several pages, and a sampler that cuts it."""
    reference = np.ones((64, 64, 3), "f4")
    dump = write_dump(tmp_path / "cut.spool", samples(64, 64, 16)[0], reference=reference, reference_variance=np.zeros_like(reference))

    def make(size):
        (tmp_path / "cutter.py").write_text(CUTTER.format(dump=str(dump), size=size))
        return dump, f"exec:{sys.executable} {tmp_path / 'cutter.py'}"
    return make


@pytest.mark.parametrize("size", [0, 4096, 300_000])
def test_a_recording_that_is_cut_is_one_line_and_no_image(cutter, run, tmp_path, size):
    dump, sampler = cutter(size)
    run("replay", dump, "--sampler", sampler, "--spp", 4, "-o", "n.exr").failed_with(4, "cut.spool", "while it was in use")
    assert not (tmp_path / "n.exr").exists()


def test_an_evaluation_goes_on_with_the_other_recordings(cutter, run, tmp_path):
    dump, sampler = cutter(4096)
    other = write_dump(tmp_path / "other.spool", samples(16, 16, 16)[0], reference=np.ones((16, 16, 3), "f4"))
    done = run("evaluate", dump, other, "--samplers", f"{sampler},uniform", "--filters", "box", "--spp", 4, "--replicates", 2,
               "--no-pictures", "-o", "results")
    done.failed_with(1, "results failed", "while it was in use")
    errors = {(Path(row["dump"]).stem, row["sampler"].split(":")[0]): row["error"] for row in rows_of(tmp_path / "results")}
    # The sampler has its own recording only; what it says about the other one is its affair.
    assert "while it was in use" in errors["cut", "cutter"] and "while it was in use" in errors["cut", "uniform"], errors
    assert errors["other", "uniform"] == "", errors
