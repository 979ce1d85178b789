"""The committed recordings: whole, and their samples are what their headers claim."""
import subprocess
import sys

import pytest
from conftest import ROOT

DUMPS = sorted((ROOT / "dumps" / "tiny").glob("*.spool"))


def test_there_are_dumps_and_they_stay_small():
    assert len(DUMPS) == 7
    assert sum(d.stat().st_size for d in DUMPS) < 24e6


@pytest.mark.parametrize("dump", DUMPS, ids=lambda d: d.stem)
def test_samples_of_the_dump_are_what_its_header_claims(dump):
    done = subprocess.run([sys.executable, ROOT / "dumps" / "verify" / "verify.py", dump], capture_output=True,
                          text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "reference error" in done.stdout


@pytest.mark.parametrize("dump", DUMPS, ids=lambda d: d.stem)
def test_the_page_tells_the_command_that_made_the_dump(dump):
    page = (ROOT / "dumps" / "tiny" / "README.md").read_text()
    assert "--compress -o dumps/tiny/%s" % dump.name in page
