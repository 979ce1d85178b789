import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats" / "python"))
TOOL = os.environ.get("SPOOL_INTERCHANGE_TOOL")


def run_jobs(*jobs):
    """Each job is (verb, in, out, *options) -> list of (code, message)."""
    text = "".join("\t".join(map(str, job)) + "\n" for job in jobs)
    done = subprocess.run([TOOL], input=text, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert len(lines) == len(jobs), done.stdout
    return [(int(line.partition(" ")[0]), line.partition(" ")[2]) for line in lines]


@pytest.fixture(scope="session", autouse=True)
def tool():
    if TOOL is None:
        pytest.skip("SPOOL_INTERCHANGE_TOOL is not set; run it through ctest")
