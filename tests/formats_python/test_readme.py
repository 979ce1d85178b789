"""The code in the README files runs: Python here, C++ compiled as a stranger would."""
import os
import re
import shutil
import subprocess

import numpy as np
import pytest
import spool

from conftest import ROOT

FRAME = """#include <cstddef>
#include <span>
#include <vector>
%s
int main() {
%s  return 0;
}
"""


def blocks(page, language):
    found = re.findall(rf"```{language}\n(.*?)```", (ROOT / page).read_text(), re.S)
    assert found
    return found


def lines(code):
    return [line for line in code.splitlines() if line.strip()]


def test_readme_code_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in blocks("formats/python/README.md", "python"):
        exec(code, names)
    assert names["image"].shape == (64, 64, 3)
    assert (tmp_path / "passes.spool").exists()


def test_ten_lines_of_python_write_a_valid_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = blocks("docs/formats.md", "python")[0]
    names = {}
    exec(code, names)
    assert len(lines(code)) <= 10
    assert names["image"].shape == (48, 64, 3)
    assert spool.check("mine.spool").ok
    with spool.open("mine.spool") as dump:
        assert np.array_equal(dump.read("radiance"), names["radiance"])


def test_ten_lines_of_cpp_write_a_valid_file(tmp_path):
    library = os.environ.get("SPOOL_FORMATS_LIBRARY")
    if library is None:
        pytest.skip("SPOOL_FORMATS_LIBRARY is not set; run it through ctest")
    compiler = shutil.which(os.environ.get("CXX", "g++")) or pytest.skip("no C++ compiler")
    code = blocks("docs/formats.md", "cpp")[0]
    assert len(lines(code)) <= 12  # two of them are #include and using
    head = [line for line in code.splitlines() if line.startswith(("#include", "using "))]
    body = [line for line in code.splitlines() if line not in head]
    (tmp_path / "mine.cpp").write_text(FRAME % ("\n".join(head), "\n".join(body) + "\n"))
    flags = os.environ.get("SPOOL_CXX_FLAGS", "").split()
    subprocess.run([compiler, "-std=c++20", *flags, f"-I{ROOT}", "mine.cpp", library, "-lfmt", "-ldeflate", "-lz", "-lzstd", "-pthread",
                    "-o", "mine"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "mine"], cwd=tmp_path, check=True)
    assert spool.check(tmp_path / "mine.spool").ok
    with spool.open(tmp_path / "mine.spool") as dump:
        assert dump.read("radiance").shape == (48, 64, 32, 3)
