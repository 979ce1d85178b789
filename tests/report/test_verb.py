"""`spool evaluate` and then `spool report`, as people use them."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

import spool
from tools.report.assets import ASSETS, cache_folder, pinned_hashes
from tools.report.exr_image import read_exr, rgb
from tools.report.report import main
from tools.report.results_table import read_results

PROGRAM = os.environ.get("SPOOL_PROGRAM", "spool")


def run(*arguments, **environment):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                          env={**os.environ, **environment})


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("evaluated")
    random = np.random.default_rng(1)
    mean = np.linspace(0.2, 1.0, 40)[None, :] * np.where(np.arange(36) < 18, 1, 3)[:, None]
    radiance = (mean[:, :, None, None] * random.exponential(1.0, (36, 40, 32, 3))).astype("<f4")
    spool.write(folder / "edge.spool", radiance=radiance, sample_order="exchangeable", tile_size=16, block_spp=8)
    done = run("evaluate", folder / "edge.spool", "--samplers", "uniform", "--filters", "box,gaussian", "--spp", "4,8",
               "--replicates", "3", "-o", folder / "results", "-q")
    assert done.returncode == 0, done.stderr
    return folder


def have_assets():
    return all((cache_folder() / asset.script).exists() for asset in ASSETS)


def test_the_manifest_says_what_was_run(evaluated):
    manifest = json.loads((evaluated / "results" / "manifest.json").read_text())
    assert "evaluate" in manifest["command"] and "--replicates 3" in manifest["command"]
    assert manifest["version"].startswith("spool ") and manifest["machine"]["threads"] >= 1
    told = json.loads(run("info", evaluated / "edge.spool", "--json").stdout)
    assert [d["index_sha256"] for d in manifest["dumps"]] == [told["index_sha256"]]


def test_the_squared_error_is_that_of_estimate_and_reference_where_it_counts(evaluated):
    """The EXR files that the program writes are read right: their error agrees with results.csv."""
    row = next(r for r in read_results(evaluated / "results" / "results.csv").rows
               if (r["filter"], r["spp"], r["replicate"]) == ("gaussian", 4.0, 0.0))
    stem = evaluated / "results" / "edge_uniform_gaussian_4spp"
    estimate = rgb(read_exr(stem / "estimate.exr")).astype(float)
    reference = rgb(read_exr(evaluated / "results" / "edge_reference.exr")).astype(float)
    assert np.sqrt(np.mean((estimate - reference) ** 2)) == pytest.approx(row["rmse"], rel=1e-5)
    error = read_exr(stem / "squared_error.exr")["Y"].astype(float)
    assert error.mean() == pytest.approx(row["mse"], rel=1e-5)


@pytest.mark.skipif(not have_assets(), reason="SKIPPED: tools/report/fetch_assets.sh has not been run")
def test_a_report_of_a_real_evaluation(evaluated):
    output = evaluated / "report.html"
    done = run("report", evaluated / "results", "-o", output, SPOOL_PYTHON=sys.executable)
    assert done.returncode == 0, done.stderr
    assert "12 results" in done.stdout and done.stdout.count("\n") == 1
    html = output.read_text()
    manifest = json.loads((evaluated / "results" / "manifest.json").read_text())
    assert manifest["dumps"][0]["index_sha256"] in html and manifest["version"] in html
    text = html.split('id="report-data">')[1].split("</script>")[0]
    data = json.loads(text)
    assert len(data["combinations"]) == 4 and len(data["pictures"]["sets"]) == 4
    assert {"estimate", "reference", "squared_error", "density"} <= set(data["pictures"]["sets"][0]["images"])
    assert all(q["meaning"] for q in data["quantities"])
    again = run("report", evaluated / "results", "-o", output, SPOOL_PYTHON=sys.executable)
    assert again.returncode == 2 and "--force" in again.stderr and again.stderr.count("\n") == 1


def failed(done, code, *words):
    assert done.returncode == code, (done.returncode, done.stderr)
    assert done.stderr.count("\n") == 1
    for word in words:
        assert word in done.stderr


def test_what_is_missing_is_named_in_one_line(evaluated, tmp_path):
    output = tmp_path / "a.html"
    failed(run("report", tmp_path, "-o", output, SPOOL_PYTHON=sys.executable), 3, "results.csv", "spool evaluate")
    failed(run("report", evaluated / "results", "-o", output, SPOOL_PYTHON="no-such-python"), 2, "no-such-python", "numpy")
    failed(run("report", evaluated / "results", "-o", output, SPOOL_PYTHON=sys.executable,
               SPOOL_REPORT_ASSETS=str(tmp_path)), 3, "fetch_assets.sh")
    failed(run("report", evaluated / "results", "-o", output, SPOOL_REPORT=str(tmp_path)), 3, "SPOOL_REPORT")
    blocker = tmp_path / "numpy.py"
    blocker.write_text("raise ImportError('none')")
    failed(run("report", evaluated / "results", "-o", output, SPOOL_PYTHON=sys.executable, PYTHONPATH=str(tmp_path)), 2,
           "no numpy")
    assert not output.exists() and pinned_hashes()


def test_a_report_replaces_no_pipe_or_device_and_no_link_unasked(evaluated, tmp_path):
    pipe, link = tmp_path / "pipe.html", tmp_path / "link.html"
    os.mkfifo(pipe)
    link.symlink_to("nowhere.html")
    failed(run("report", evaluated / "results", "-o", pipe, "--force", SPOOL_PYTHON=sys.executable), 2, "pipe.html", "no regular file")
    failed(run("report", evaluated / "results", "-o", link, SPOOL_PYTHON=sys.executable), 2, "link.html", "--force")
    assert pipe.is_fifo() and link.is_symlink()


def leaves(value, path=()):
    """(path, value) of every leaf; of a list, only the first and the last entry."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list) and value:
        for i in sorted({0, len(value) - 1}):
            yield from leaves(value[i], (*path, i))
    yield path, value


def replaced(value, path, new):
    if not path:
        return new
    copy = dict(value) if isinstance(value, dict) else list(value)
    copy[path[0]] = replaced(value[path[0]], path[1:], new)
    return copy


@pytest.mark.parametrize("name", ["statistics.json", "manifest.json"])
def test_no_file_of_the_folder_puts_markup_or_a_traceback_into_the_page(evaluated, tmp_path, capsys, assets_cache, name):
    """Every place of the file in turn holds markup, the wrong type, NaN: a page without it, or one sentence."""
    folder = tmp_path / "r"
    folder.mkdir()
    for file in ("results.csv", "statistics.json", "manifest.json"):
        shutil.copy(evaluated / "results" / file, folder)
    sound = json.loads((folder / name).read_text())
    pages = refusals = 0
    for path, _ in leaves(sound):
        for new in ('<h1><meta http-equiv=refresh content="1;url=http://127.0.0.1/">', 7, None, float("nan"), [], {}):
            (folder / name).write_text(json.dumps(replaced(sound, path, new)))
            code = main([str(folder), "-o", str(tmp_path / "a.html"), "--force"])
            error = capsys.readouterr().err
            if code == 0:
                pages += 1
                html = (tmp_path / "a.html").read_text()
                assert "<meta http-equiv=refresh" not in html, path
            else:
                refusals += 1
                assert code == 1 and error.count("\n") == 1 and "Error" not in error, (path, new, error)
    assert pages > 50 and (refusals > 20 or name != "statistics.json")


def test_what_is_no_json_or_nested_too_deep_is_said_in_a_sentence(evaluated, tmp_path, capsys, assets_cache):
    shutil.copy(evaluated / "results" / "results.csv", tmp_path)
    for name in ("statistics.json", "manifest.json"):
        for text in ("{", "[" * 200000, "\udcff".encode("utf-8", "surrogateescape")):
            (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
            assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 1
            error = capsys.readouterr().err
            assert name in error and error.count("\n") == 1 and "Error" not in error
        (tmp_path / name).unlink()


def test_a_line_end_in_a_field_stays_in_the_one_line(evaluated, tmp_path):
    shutil.copytree(evaluated / "results", tmp_path / "r")
    header, first = (tmp_path / "r/results.csv").read_text().splitlines()[:2]
    fields = first.split(",")
    fields[header.split(",").index("relmse")] = '"a\nb\x1b[2Jc"'
    (tmp_path / "r/results.csv").write_text(f"{header}\n{','.join(fields)}\n")
    done = run("report", tmp_path / "r", "-o", tmp_path / "r.html")
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "relmse" in done.stderr, done.stderr
    assert r"'a\nb\x1b[2Jc'" in done.stderr, done.stderr
