"""docs/python.md runs as it stands, and the package has what the numpy one has."""
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import spool

ROOT = Path(os.environ["SPOOL_FORMAT_MODULES"]).parents[1]


def blocks(text):
    return re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)


def test_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    code = "\n".join(blocks((ROOT / "docs" / "python.md").read_text(encoding="utf-8")))
    script = tmp_path / "page.py"
    script.write_text(code.replace("results/", f"{tmp_path}/results/"), encoding="utf-8")
    done = runpy.run_path(str(script))
    ratio = done["ratio"]
    said = float(re.search(r"has (0\.\d+) times the relMSE of uniform", (ROOT / "docs" / "python.md").read_text())[1])
    assert abs(ratio - said) < 0.005 and ratio < 1


def test_the_lines_of_the_readme(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    code, = blocks((ROOT / "README.md").read_text(encoding="utf-8"))
    exec(compile(code, "README.md", "exec"), {})
    assert 0.005 < float(capsys.readouterr().out) < 0.05


def test_it_holds_the_numpy_package():
    environment = {**os.environ, "PYTHONPATH": os.environ["SPOOL_FORMAT_MODULES"]}
    listed = subprocess.run([sys.executable, "-c", "import spool, sys; print(*spool.__all__); "
                             "assert 'spool._core' not in sys.modules"],
                            env=environment, check=True, capture_output=True, text=True).stdout.split()
    assert set(listed) <= set(spool.__all__) and len(listed) > 8
    from spool import exr
    assert exr.read and exr.write
