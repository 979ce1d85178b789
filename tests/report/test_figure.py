"""`spool figure`: figures hold the numbers of statistics.json, tables make bold only what a verdict says."""

import csv
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from made_results import make_rows, write_images, write_results

pytest.importorskip("matplotlib", reason="SKIPPED: no matplotlib in this Python")

from matplotlib import pyplot

from tools.report import figure
from tools.report.figure import main
from tools.report.figure_tables import markdown
from tools.report.figure_text import latex, literal, significant
from tools.report.draw_curves import panel, read
from tools.report.file_names import dump_names, file_name_of

PICTURES = ("curves", "curves_time", "comparison", "comparison_chess", "comparison_kitchen")
PROGRAM = os.environ.get("SPOOL_PROGRAM", "spool")


@pytest.fixture(scope="module")
def drawn(made_folder, tmp_path_factory):
    output = tmp_path_factory.mktemp("figures") / "f"
    assert main([str(made_folder), "-o", str(output)]) == 0
    return output


@pytest.fixture(scope="module")
def small_folder(tmp_path_factory):
    """Two recordings, one method, one budget: for what is about files and not about what they show."""
    folder = tmp_path_factory.mktemp("small")
    rows = make_rows(samplers=("uniform",), filters=("box",), budgets=(4,), replicates=2, size=(20, 16))
    write_results(folder, rows)
    write_images(folder, rows, dump_names(dict.fromkeys(row["dump"] for row in rows)), file_name_of)
    return folder


def conditions(folder):
    data = json.loads((folder / "statistics.json").read_text())
    return [c for c in data["conditions"] if c["metric"] == "relmse"]


def name_of(entry):
    return f"{entry['sampler']} + {entry['filter']}"


def test_every_file_is_written_and_fonts_are_embedded(drawn):
    names = {path.name for path in drawn.iterdir()}
    pictures = {f"{stem}.{kind}" for stem in PICTURES for kind in ("pdf", "svg", "png")}
    assert names == pictures | {"curves.csv", "curves.py", "figure_text.py", "metric_names.py", "captions.tex", "table.tex", "table.md"}
    for path in drawn.glob("*.pdf"):
        data = path.read_bytes()
        assert data.startswith(b"%PDF") and b"/FontFile2" in data and b"/Type3" not in data
    for path in drawn.glob("*.svg"):
        text = path.read_text()
        assert "<text" not in text and "http" not in re.sub(r'xmlns[^"]*"[^"]*"|"http[^"]*DTD[^"]*"|<metadata.*?</metadata>',
                                                            "", text, flags=re.S)


def test_the_curves_are_those_of_the_file(drawn, made_folder):
    rows = {(r["scene"], r["method"], float(r["spp"])): r for r in csv.DictReader((drawn / "curves.csv").open())}
    expected = [(c, e) for c in conditions(made_folder) for e in c["ranking"]]
    assert len(rows) == len(expected) == 54
    for condition, entry in expected:
        row = rows[Path(condition["dump"]).stem, name_of(entry), condition["spp"]]
        assert [float(row[k]) for k in ("mean", "low", "high")] == entry["value"]


def test_the_script_draws_the_same_curves_again(drawn, tmp_path):
    subprocess.run([sys.executable, str(drawn / "curves.py"), str(drawn / "curves.csv"), "-o", str(tmp_path / "again")],
                   check=True, capture_output=True)
    for kind in ("pdf", "svg", "png"):
        for name in ("", "_time"):
            assert (tmp_path / f"again{name}.{kind}").read_bytes() == (drawn / f"curves{name}.{kind}").read_bytes()


@pytest.mark.parametrize("told", [True, False])
def test_the_best_is_bold_only_where_a_verdict_says_so(tmp_path, told):
    write_results(tmp_path, make_rows(noise=0.005))
    data = json.loads((tmp_path / "statistics.json").read_text())
    for condition in data["conditions"]:
        for i, entry in enumerate(condition["ranking"][1:]):
            entry["against_best"] = "worse" if told or i > 0 else "undecided"
    (tmp_path / "statistics.json").write_text(json.dumps(data))
    assert main([str(tmp_path), "-o", str(tmp_path / "f")]) == 0  # no pictures: no comparison
    tex, text = (tmp_path / "f" / "table.tex").read_text(), (tmp_path / "f" / "table.md").read_text()
    assert tex.count(r"\mathbf") == (6 if told else 0)
    assert text.count("**0") == (6 if told else 0)
    for condition in conditions(tmp_path):
        for entry in condition["ranking"]:
            mean, low, high = map(significant, entry["value"])
            bold = told and entry is condition["ranking"][0]
            assert rf"${rf'{chr(92)}mathbf{{{mean}}}' if bold else mean}_{{\,{low}}}^{{\,{high}}}$" in tex
            assert f"{mean} [{low}, {high}]" in text.replace("\\", "")


def test_a_choice_of_methods_and_budget_is_kept_and_a_wrong_one_named(made_folder, tmp_path, capsys):
    arguments = [str(made_folder), "-o", str(tmp_path / "f"), "--spp", "4", "--recording", "chess",
                 "--method", "uniform + box", "--method", "mitchell + gaussian"]
    assert main(arguments) == 0
    assert not (tmp_path / "f" / "comparison_kitchen.pdf").exists() and (tmp_path / "f" / "comparison_chess.pdf").exists()
    drawn = {r["method"]: r["drawn"] for r in csv.DictReader((tmp_path / "f" / "curves.csv").open()) if r["drawn"] != "0"}
    assert drawn == {"uniform + box": "1", "mitchell + gaussian": "2"}
    capsys.readouterr()
    for extra, word in ((["--method", "best + ever"], "best + ever"), (["--spp", "5"], "5 samples"),
                        (["--recording", "x"], "no x"), (["--metric", "mae"], "relmse"), ([], "--force"),
                        (["--font", "latex:a b"], "latex:PACKAGE"), (["--font", "\\input"], "latex:PACKAGE"),
                        ([f"--method=m{i} + x" for i in range(9)], "no 'm0 + x'")):
        assert main([*arguments, *extra]) == 2
        error = capsys.readouterr().err
        assert word in error and error.count("\n") == 1
    assert main([*arguments, "--force"]) == 0


def test_hostile_names_stay_text(tmp_path):
    hostile = r"\input{/etc/passwd}$x_1$&%<b>"
    rows = make_rows(dumps=("a.spool",), samplers=("uniform", hostile), budgets=(4,))
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(["a.spool"]), file_name_of)
    assert main([str(tmp_path), "-o", str(tmp_path / "f"), "--method", f"{hostile} + box", "--method", "uniform + box"]) == 0
    for name in ("table.tex", "captions.tex"):
        tex = (tmp_path / "f" / name).read_text().replace(r"\allowbreak{}", "")
        assert r"\input" not in tex and r"\textbackslash{}input\{/etc/passwd\}\$x\_1\$\&\%\textless{}b" in tex
    assert "<b>" not in (tmp_path / "f" / "table.md").read_text()
    assert latex("a_b%") == r"a\_b\%" and markdown("a|b\nc") == r"a\|b c" and markdown("~a~ $b$ &lt;") == r"\~a\~ \$b\$ \&lt;"


def test_what_cannot_be_drawn_is_told_and_an_interval_beside_its_mean_is_drawn(small_folder, tmp_path, capsys):
    def told(*values):
        shutil.copytree(small_folder, tmp_path / "r", dirs_exist_ok=True)
        data = json.loads((tmp_path / "r" / "statistics.json").read_text())
        for condition, value in zip((c for c in data["conditions"] if c["metric"] == "relmse"), values):
            condition["ranking"][0]["value"] = value
        (tmp_path / "r" / "statistics.json").write_text(json.dumps(data))
        assert main([str(tmp_path / "r"), "-o", str(tmp_path / "f"), "--force"]) == 0
        return capsys.readouterr().out, (tmp_path / "f" / "captions.tex").read_text()
    said, captions = told([1.95e-31, 1.9500000000000003e-31, 1.9499999999999998e-31], [0, 0, 0])
    assert ", curves, captions" in said and captions.count(" Not drawn: 1 mean not above zero.") == 2
    said, captions = told([0, 0, 0], [-1e-9, -2e-9, 1e-9])
    assert "; no mean above zero, so no curves" in said and "curves" not in captions and ", curves" not in said


def test_an_interval_that_reaches_zero_leaves_the_panel_and_does_not_stretch_it():
    axes = pyplot.figure().add_subplot()
    panel(axes, {"a": [(4.0, 0.02, 0.01, 0.04, 1.0)], "b": [(4.0, 0.01, 0.0, 0.03, 1.0)]}, {"a": 0, "b": 1}, 3.0, False)
    low, high = axes.get_ylim()
    least = [line.vertices[0, 1] for bars in axes.containers for line in bars.lines[2][0].get_paths()]
    pyplot.close(axes.figure)
    assert 0.009 < low < 0.01 and 0.04 < high < 0.05
    assert least[0] == pytest.approx(0.01) and least[1] == 0.0


def test_a_folder_without_a_finished_result_is_named(tmp_path, capsys):
    rows = make_rows(samplers=("uniform",), filters=("box",), budgets=(4,), replicates=2)
    for row in rows:
        row.update(dict.fromkeys(list(row)[6:], ""), error="not enough samples")
    write_results(tmp_path / "r", rows)
    data = json.loads((tmp_path / "r" / "statistics.json").read_text())
    (tmp_path / "r" / "statistics.json").write_text(json.dumps({**data, "conditions": []}))
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "f")]) == 1
    assert capsys.readouterr().err == f"{tmp_path / 'r'}: no result to draw: results.csv says why\n"


def test_a_letter_that_no_font_has_is_an_escape():
    assert literal("ü Ж مر 漢 𝒳") == "ü Ж \\u0645\\u0631 \\u6f22 𝒳"


def with_group(made, tmp_path, group):
    """The made results with `group` as the label of both recordings."""
    folder = tmp_path / "results"
    shutil.copytree(made, folder)
    data = json.loads((folder / "statistics.json").read_text())
    for scene in data["scenes"]:
        scene["group"] = group
    (folder / "statistics.json").write_text(json.dumps(data))
    return folder


@pytest.mark.parametrize("group", ["day/noon", "x/../../ESC", "..", "/etc/x", "a\0b\x1b[1m", "line\n\nend", "\udcff", "n" * 400])
def test_a_group_of_any_name_has_its_files_in_the_folder(small_folder, tmp_path, group):
    folder, output = with_group(small_folder, tmp_path, group), tmp_path / "out" / "f"
    (output / "comparison_x").mkdir(parents=True)
    assert main([str(folder), "-o", str(output)]) == 0
    stem = f"comparison_{file_name_of(group)}"
    names = {path.name for path in output.iterdir() if path.is_file()}
    assert {f"{stem}{i}.{kind}" for i in ("", "-2") for kind in ("pdf", "svg", "png")} < names and len(names) == 22
    assert {p.name for p in tmp_path.iterdir()} == {"results", "out"} and [*(tmp_path / "out").iterdir()] == [output]
    for path in output.glob("*.svg"):
        ElementTree.parse(path)
    for name in ("table.tex", "table.md", "curves.csv"):
        assert all(c.isprintable() or c == "\n" for c in (output / name).read_text())


def test_links_are_replaced_and_never_followed(small_folder, tmp_path, capsys):
    output, victim = tmp_path / "f", tmp_path / "victim"
    assert main([str(small_folder), "-o", str(output)]) == 0
    names = sorted(path.name for path in output.iterdir())
    for name in names:
        for target in (victim, tmp_path / "nothing"):
            victim.write_text("kept")
            (output / name).unlink()
            (output / name).symlink_to(target)
            assert main([str(small_folder), "-o", str(output)]) == 2
            assert "--force" in capsys.readouterr().err
    assert main([str(small_folder), "-o", str(output), "--force"]) == 0
    assert victim.read_text() == "kept" and not (tmp_path / "nothing").exists()
    assert sorted(path.name for path in output.iterdir()) == names and not any(p.is_symlink() for p in output.iterdir())


@pytest.mark.parametrize("bytes_left", [0, 100, 5000, 30000])
def test_a_full_disk_leaves_nothing_half(small_folder, tmp_path, bytes_left):
    """A limit of file size gives the failed write of a full disk."""
    command = [sys.executable, Path(figure.__file__).with_name("run.py"), "figure", small_folder, "-o", tmp_path / "f"]
    def limited():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_left, bytes_left))
    full = subprocess.run(command, capture_output=True, text=True, preexec_fn=limited)
    assert full.returncode == 3 and str(tmp_path / "f") in full.stderr and full.stderr.count("\n") == 1, full.stderr
    assert "None" not in full.stderr and [*tmp_path.iterdir()] == []
    assert subprocess.run(command, capture_output=True).returncode == 0  # no --force needed


@pytest.mark.parametrize("by_program", [True, False])
def test_an_interrupt_leaves_nothing_half(made_folder, tmp_path, by_program):
    """The program kills the script when it is interrupted; the script alone may be killed, too."""
    verb = [PROGRAM, "figure"] if by_program else [sys.executable, Path(figure.__file__).with_name("run.py"), "figure"]
    running = subprocess.Popen([*verb, made_folder, "-o", tmp_path / "f"], stderr=subprocess.DEVNULL,
                               env={**os.environ, "SPOOL_PYTHON": sys.executable})
    wait_until(lambda: list(tmp_path.glob("f/.figure.*.partial")) or running.poll() is not None)
    assert running.poll() is None
    running.send_signal(signal.SIGINT if by_program else signal.SIGKILL)
    assert running.wait() == (130 if by_program else -signal.SIGKILL)
    wait_until(lambda: not (tmp_path / "f").exists())


def wait_until(holds, seconds=120):
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.mark.parametrize("group", ["=cmd|' /C calc'!A0", "+1", "-1", "@SUM(1)", "'=1", "plain"])
def test_no_cell_of_the_curves_begins_like_a_formula(small_folder, tmp_path, group):
    assert main([str(with_group(small_folder, tmp_path, group)), "-o", str(tmp_path / "f")]) == 0
    for row in csv.reader((tmp_path / "f" / "curves.csv").open()):
        assert not any(cell.startswith(tuple("=+-@")) for cell in row)
    assert list(read(tmp_path / "f" / "curves.csv")[0]) == [group]


def test_each_number_of_threads_has_its_figure(tmp_path):
    (tmp_path / "p.toml").write_text('recordings = ["s.spool"]\nspp = [2]\nthreads = [1, 2]\nreplicates = 2\nsamplers = ["uniform"]\n'
                                     'filters = ["box"]\n')
    for words in (["synth", "scene_s", "--size", "24", "--samples", "8", "-o", "s.spool"], ["evaluate", "p.toml", "-o", "r", "-q"]):
        subprocess.run([PROGRAM, *words], cwd=tmp_path, check=True, capture_output=True)
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "f")]) == 0
    names = {path.name for path in (tmp_path / "f").glob("comparison*.pdf")}
    assert names == {"comparison.pdf", "comparison_s__1_thread.pdf", "comparison_s__2_threads.pdf"}
    captions = (tmp_path / "f/captions.tex").read_text()
    assert "caption{s [1 thread] and s [2 threads] at" in captions and "{comparison_s__2_threads.pdf}" in captions


def test_a_plan_is_evaluated_first(tmp_path):
    def run(*words):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=300,
                              env={**os.environ, "SPOOL_PYTHON": sys.executable})
    assert run("synth", "scene_s", "--size", "24", "--samples", "32", "-o", tmp_path / "s.spool", "-q").returncode == 0
    (tmp_path / "p.toml").write_text('recordings = "s.spool"\nspp = 4\nreplicates = 2\nsamplers = "uniform"\nfilters = ["box", "gaussian"]\n'
                                     '[metrics]\nperceptual = "none"\n')
    done = run("figure", tmp_path / "p.toml", "-o", tmp_path / "f")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "f" / "comparison_s.pdf").exists() and (tmp_path / "f" / "results" / "statistics.json").exists()
    again = run("figure", tmp_path / "f" / "results", "-o", tmp_path / "f")
    assert again.returncode == 2 and "--force" in again.stderr
