"""A plan of 10,000 cells on a tiny recording: lists, runs and reports in bounded memory. Run by tools/dev.sh endure."""
import csv
import json
import os
import subprocess
import time

import pytest

from conftest import PROGRAM, samples, write_dump

pytestmark = pytest.mark.skipif("SPOOL_LARGE_PLAN" not in os.environ, reason="by tools/dev.sh endure")

PLAN = """
recordings = ["tiny.spool"]
spp = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
replicates = {replicates}
pictures = false
samplers = ["uniform", "mitchell"]
[metrics]
perceptual = "none"
[[filter]]
name = "box"
[[filter]]
name = "gaussian"
sigma = [0.5, 0.75, 1, 1.5]
"""


def measured(folder, *arguments):
    """Exit code, seconds of wall and CPU, and largest resident megabytes of one run of the program."""
    started = time.monotonic()
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=folder, stdout=open(folder / "out.txt", "wb"),
                               stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, (arguments, process.returncode)
    return time.monotonic() - started, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def test_ten_thousand_cells(tmp_path):
    write_dump(tmp_path / "tiny.spool", samples(width=16, height=16)[0])
    memory = {}
    for replicates in (10, 100):
        cells = 100 * replicates
        (tmp_path / "plan.toml").write_text(PLAN.format(replicates=replicates))
        for words in (["--dry-run", "--json"], ["-o", f"r{cells}", "-q"], ["-o", f"r{cells}", "-q"],
                      ["--merge", "-o", f"r{cells}", "-q"]):
            wall, cpu, memory[cells] = measured(tmp_path, "evaluate", "plan.toml", *words)
            print(f"{cells} cells, {' '.join(words)}: {wall:.1f} s, CPU {cpu:.1f} s = {1000 * cpu / cells:.2f} ms per cell, "
                  f"{memory[cells]:.0f} MB")
            if words[0] == "--dry-run":
                assert json.loads((tmp_path / "out.txt").read_text())["cells"] == cells
        with open(tmp_path / f"r{cells}/results.csv", newline="") as file:
            assert len(list(csv.DictReader(file))) == cells
        wall, cpu, used = measured(tmp_path, "report", f"r{cells}", "-o", f"{cells}.html")
        size = (tmp_path / f"{cells}.html").stat().st_size
        print(f"{cells} cells, report: {wall:.1f} s, CPU {cpu:.1f} s, {used:.0f} MB, page of {size / 1e6:.1f} MB")
        assert size < 10e6
    growth = 1e6 * (memory[10000] - memory[1000]) / 9000
    row = (tmp_path / "r10000/results.csv").stat().st_size / 10000
    print(f"memory grows by {growth:.0f} bytes a cell, whose row in results.csv has {row:.0f}")
    assert growth < 4 * row
