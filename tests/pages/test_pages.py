"""Every command and every script of these pages, in their order, in a folder beside the recordings."""
import os
import re
import subprocess
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```(sh|python|toml)\n(.*?)^```$", re.M | re.S)
NAMED = re.compile(r"saved as `([\w.]+)`")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/spool").symlink_to(os.environ["SPOOL_PROGRAM"])
    (tmp_path / "bin/python3").symlink_to(os.environ["SPOOL_PYTHON"])
    (tmp_path / "dumps").symlink_to(TREE / "dumps")
    return tmp_path


def type_page(page, folder):
    """Scripts get the name of their first line, plans that of the line behind them; commands run as they stand."""
    text = (TREE / "docs" / page).read_text(encoding="utf-8")
    commands = 0
    # SPOOL_... of the test machine would help the program where a reader has nothing.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("SPOOL_") or name == "SPOOL_PYTHON"}
    environment["PATH"] = f"{folder / 'bin'}:{environment['PATH']}"
    blocks = list(BLOCK.finditer(text))
    for kind in ("python", "toml", "sh"):
        for block in blocks:
            if block[1] != kind:
                continue
            if kind == "sh":
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", block[2]], cwd=folder, env=environment,
                                      capture_output=True, text=True, check=False, timeout=600)
                assert done.returncode == 0, (page, block[2], done.stdout[-2000:], done.stderr[-2000:])
                commands += len(block[2].splitlines())
                continue
            name = re.match(r"# ([\w.]+)", block[2]) if kind == "python" else NAMED.search(text, block.end())
            (folder / name[1]).write_text(block[2], encoding="utf-8")
    return commands


def test_the_tutorial_runs_from_recording_to_figure(folder):
    assert type_page("tutorial.md", folder) >= 12
    assert (folder / "plain.png").read_bytes().startswith(b"\x89PNG")
    assert "plotly" in (folder / "report.html").read_text(encoding="utf-8").lower()
    assert list((folder / "figures").glob("comparison_*.pdf")) and (folder / "figures/table.tex").is_file()
    labels = (folder / "change/results.csv").read_text(encoding="utf-8")
    assert "ours" in labels and "eager" in labels


def test_a_metric_of_one_s_own_in_python_and_in_cpp(folder):
    assert type_page("own_metric.md", folder) == 2
    results = folder / "results"
    said = subprocess.run([os.environ["SPOOL_PYTHON"], "log_error.py", "results"], cwd=folder, capture_output=True,
                          text=True, check=True).stdout
    stops = dict(line.split() for line in said.splitlines())
    assert len(stops) == 4
    for name, value in stops.items():
        done = subprocess.run([os.environ["SPOOL_LOG_ERROR"], results / name / "estimate.exr",
                               results / "chess_reference.exr"], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == value
    assert float(stops["chess_multiscale_directional_8spp"]) < float(stops["chess_uniform_box_8spp"])


def test_samples_of_one_s_own_renderer(folder):
    assert type_page("own_import.md", folder) == 7
    import numpy as np
    import spool
    with spool.open(str(folder / "mine.spool")) as dump:
        rows = dump.read("radiance").mean(axis=(1, 2, 3))
    assert rows.shape == (24,) and rows[0] > 3 * rows[-1], "the file's last row is the upper one"
    with spool.open(str(folder / "made.spool")) as dump:
        assert np.array_equal(dump.read("radiance"), np.load(folder / "made.npz")["radiance"])
