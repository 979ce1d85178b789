"""The installed program finds its report, its scripts and its PNG module by itself; the headers are all there."""
import os
import re

from conftest import TREE, run

CHESS = TREE / "dumps/tiny/chess.spool"


def test_every_header_that_a_header_includes_is_installed(prefix):
    installed = prefix / "include/spool"
    headers = sorted(installed.rglob("*.h"))
    assert len(headers) > 200
    included = {name for header in headers
                for name in re.findall(r'^#include "([^"]+)"', header.read_text(encoding="utf-8"), re.M)}
    assert {name for name in included if not (installed / name).is_file()} == set()
    assert not list((prefix / "include").rglob("*.cpp"))


def test_the_version_is_that_of_the_project(prefix):
    assert run(prefix / "bin/spool", "--version").strip() == "spool " + os.environ["SPOOL_VERSION"]


def test_a_report_and_a_picture_need_nothing_but_what_is_installed(prefix, tmp_path):
    environment = {"HOME": str(tmp_path / "nobody"), "XDG_CACHE_HOME": str(tmp_path / "nothing"),
                   "SPOOL_PYTHON": os.environ["SPOOL_PYTHON"]}
    spool = prefix / "bin/spool"
    run(spool, "evaluate", CHESS, "--spp", "4", "--replicates", "2", "-o", "results", folder=tmp_path, **environment)
    run(spool, "report", "results", "-o", "report.html", folder=tmp_path, **environment)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Plotly" in page and "Tablesort" in page and "chess" in page
    run(spool, "reconstruct", CHESS, "--filter", "box", "-o", "box.png", folder=tmp_path, **environment)
    assert (tmp_path / "box.png").read_bytes().startswith(b"\x89PNG")


def test_nothing_installed_names_the_tree_or_the_build(prefix):
    words = [str(TREE).encode(), os.environ["SPOOL_BUILD"].encode()]
    texts = [path for path in prefix.rglob("*") if path.suffix in {".cmake", ".pc", ".h", ".py"}]
    assert texts
    assert [path for path in texts if any(word in path.read_bytes() for word in words)] == []
