"""The notebook runs from its first cell to its last, by a kernel of the docs' Python with the package in reach."""
import os
import subprocess
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
VENV = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "spool/docs-venv/bin"

RUN = """
import sys, jupytext, nbclient, nbformat
book = jupytext.read(sys.argv[1])
nbclient.NotebookClient(book, timeout=600, kernel_name="python3").execute()
nbformat.write(book, "done.ipynb")
print("".join(output.get("text", "") for cell in book.cells for output in cell.get("outputs", [])))
print("".join(output.get("data", {}).get("text/html", "") for cell in book.cells for output in cell.get("outputs", [])))
"""


def test_the_notebook_runs(tmp_path):
    assert (VENV / "jupytext").is_file(), "no jupytext: tools/dev.sh setup docs"
    (tmp_path / "dumps").symlink_to(TREE / "dumps")
    done = subprocess.run([VENV / "python", "-c", RUN, TREE / "docs/examples/first_evaluation.py"], cwd=tmp_path,
                          capture_output=True, text=True, check=False, timeout=800)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "64 x 64 pixels, 64 samples each" in done.stdout and done.stdout.count("multiscale") >= 5
    assert done.stdout.count("<iframe ") == 2 and done.stdout.count("data:image/png") == 2
