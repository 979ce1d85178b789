"""The code of formats/python/README.md runs."""
import re

from conftest import ROOT


def test_readme_code_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in re.findall(r"```python\n(.*?)```", (ROOT / "formats" / "python" / "README.md").read_text(), re.S):
        exec(code, names)
    assert names["image"].shape == (64, 64, 3)
    assert (tmp_path / "passes.spool").exists()
