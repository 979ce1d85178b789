"""What is printed is as wide as the terminal, and does not depend on one where it goes to a file."""
import fcntl
import json
import os
import pty
import re
import struct
import subprocess
import termios

import pytest
from conftest import PROGRAM, samples, write_dump

LONG = "a_long_name_of_a_filter_of_ones_own_under_study"


def shown(columns, *arguments, folder=".", stream="stdout", **environment):
    """What the program prints on a terminal of so many columns, as lines."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, stream: theirs}
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], **streams, cwd=folder, env={**os.environ, **environment})
    os.close(theirs)
    text = b""
    while True:
        try:
            part = os.read(ours, 1 << 16)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        text += part
    os.close(ours)
    assert process.wait(timeout=60) == 0
    return text.decode().replace("\r\n", "\n").splitlines()


def piped(*arguments, folder=".", **environment):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True, cwd=folder,
                          env={**os.environ, **environment}).stdout


VERBS = re.findall(r"^  ([a-z]+) {4,}", piped(), re.M)


@pytest.mark.parametrize("verb", VERBS)
def test_help_begins_with_an_example_and_fits(verb):
    lines = shown(80, verb, "--help")
    assert lines[0].startswith(f"spool {verb}: ")
    usage = next(i for i, line in enumerate(lines) if line.startswith("Usage:"))
    assert any(f"spool {verb}" in line for line in lines[1:usage])
    headings = [line for line in lines if re.fullmatch(r"[A-Z][A-Za-z ]+:", line)]
    assert "Common:" in headings or verb == "completion"
    options = re.findall(r"^  (-\S+)", "\n".join(lines), re.M)
    for columns in (80, 120, 200):
        wide = shown(columns, verb, "--help")
        assert [line for line in wide if len(line) > min(columns, 110)] == []
        assert re.findall(r"^  (-\S+)", "\n".join(wide), re.M) == options


def test_help_of_the_verb_with_most_options_is_in_groups_that_name_their_use():
    text = piped("evaluate", "--help")
    groups = re.findall(r"^([A-Z][A-Za-z ]+):$", text, re.M)
    assert groups == ["What is compared", "How it is judged", "Time and machines", "What is written", "Common", "More examples"]


LISTED = json.loads(piped("list", "--json"))


@pytest.mark.parametrize("what", [*LISTED, "presets", *sorted({*LISTED["samplers"], *LISTED["filters"]})])
def test_lists_fit_80_columns_and_have_all_their_words(what):
    lines, whole = shown(80, "list", what, "--all"), piped("list", what, "--all")
    assert [line for line in lines if len(line) > 80] == []
    lost = set(re.findall(r"\w+", whole)) - set(re.findall(r"\w+", "\n".join(lines)))
    assert lost <= {"allowed", "meaning", "of"}, "headings of columns"


@pytest.mark.parametrize("terminal, erases", {"xterm": True, "dumb": False}.items())
def test_progress_erases_its_line_where_a_terminal_can(tmp_path, terminal, erases):
    text = "\n".join(shown(80, "synth", "constant", "-o", "s.spool", folder=tmp_path, stream="stderr", TERM=terminal))
    assert ("\033[K" in text) == erases


def test_alone_it_fits_80_columns():
    lines = shown(80)
    assert max(map(len, lines)) <= 80 and len(lines) <= 55
    assert [line for line in lines if re.fullmatch(r"[A-Z][a-z ]+:", line)] == [
        "Start:", "Look:", "Record:", "One image:", "Compare methods:", "More:"]


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("evaluated")
    radiance, mean = samples(spp=32)
    reference = mean[:, :, None].repeat(3, axis=2).astype("<f4")
    write_dump(folder / "scene.spool", radiance, reference=reference)
    piped("evaluate", "scene.spool", "--filters", f"box,{LONG}=nl_means", "--spp", "2,8", "--replicates", "4",
          "--no-pictures", "-o", "out", folder=folder)
    return folder


@pytest.mark.parametrize("columns", [60, 80, 120, 200])
def test_the_table_fits_and_names_stay_whole(results, columns):
    lines = shown(columns, "evaluate", "--statistics-only", "out", folder=results)
    assert [line for line in lines if len(line) > columns] == []
    table = lines[:lines.index("")]
    assert table[0].split() == ["relMSE", "ratio", "verdict"]
    assert sum(LONG in line for line in table) == 2
    numbers = [line for line in table[1:] if re.search(r"\[[\d.e-]+, [\d.e-]+\]", line)]
    assert len(numbers) == 4 and all(re.search(r"(better|worse|undecided|no verdict|\(baseline\))$", line) for line in numbers)


def test_what_is_piped_does_not_depend_on_a_window(results):
    wide = piped("evaluate", "--statistics-only", "out", folder=results, COLUMNS="40")
    assert wide == piped("evaluate", "--statistics-only", "out", folder=results, COLUMNS="200")
    row = next(line for line in wide.splitlines() if LONG in line)
    assert row.count("[") == 2  # the error and its ratio, each with its interval, on the line of the name
    assert piped("evaluate", "--help", COLUMNS="40") == piped("evaluate", "--help", COLUMNS="200")


def test_the_remarks_are_about_what_the_table_shows(results):
    plain = piped("evaluate", "--statistics-only", "out", folder=results)
    assert "half of the MSE" not in plain and "No verdict on MSE" not in plain and "(column timing)" not in plain
    assert plain.count("About another recording") == 1
    assert "Judged by independent: the reference in the recording" in plain
    assert plain.count("MSE") < piped("evaluate", "--statistics-only", "out", "--wide", folder=results).count("MSE")


def test_recordings_with_remarks_from_import_are_named(tmp_path):
    for i in range(5):
        write_dump(tmp_path / f"s{i}.spool", samples(seed=i)[0], meta={"import_remarks": ["radiance: whole numbers"]} if i else {})
    run = ["--spp", "2", "--replicates", "2", "--no-pictures", "-o"]
    text = piped("evaluate", *(f"s{i}.spool" for i in range(5)), *run, "out", folder=tmp_path)
    assert "With remarks from import (spool info FILE shows them): s1.spool, s2.spool, s3.spool, 1 more." in " ".join(text.split())
    assert "remarks from import" not in piped("evaluate", "s0.spool", *run, "none", folder=tmp_path)
    (tmp_path / "s1.spool").unlink()  # results may be read where the recordings are not
    text = " ".join(piped("evaluate", "--statistics-only", "out", folder=tmp_path).split())
    assert re.search(r"shows them\): \S*s2.spool, \S*s3.spool, \S*s4.spool\.", text)


def test_a_weaker_judge_is_said_to_be_one(tmp_path):
    write_dump(tmp_path / "bare.spool", samples(spp=64)[0])
    text = piped("evaluate", "bare.spool", "--spp", "2", "--replicates", "2", "--no-pictures", "-o", "out", folder=tmp_path)
    assert "Judged by holdout" in text and "would be less noisy" in text


def test_every_judge_is_explained_beside_a_reference_that_was_not_chosen(dump, tmp_path):
    """`pool` had no explanation, and the recording's reference was spoken of as if there were none."""
    for kind, explained, advice in (("independent", "the reference in the recording", False), ("pool (biased)", "the mean of all samples", False),
                                    ("crossfit", "each half of every pixel's samples", True)):
        text = " ".join(piped("evaluate", dump, "--spp", "2", "--reference", kind.split()[0], "--no-pictures", "-o", kind.split()[0],
                              folder=tmp_path).split())
        assert f"Judged by {kind}: {explained}" in text
        assert ("A reference in the recording (independent) would be less noisy." in text) == advice


def test_metrics_and_times_fit_80_columns(tmp_path):
    write_dump(tmp_path / "s.spool", samples()[0])
    lines = shown(80, "evaluate", "s.spool", "--replicates", 2, "--spp", "4", "--wide", "--reference", "pool", "-o", "out", "--threads", 2, folder=tmp_path)
    assert any(line.startswith("times: of a machine") for line in lines)
    assert [line for line in lines if len(line) > 80 and "relMSE" not in line and "uniform" not in line] == []
    image = next((tmp_path / "out").rglob("estimate.exr"))
    lines = shown(80, "metrics", image, image, folder=tmp_path)
    assert "debiased" in lines[-1] and [line for line in lines if len(line) > 80] == []


def test_info_is_at_most_ten_lines(tmp_path):
    claims = [{"name": f"claim {i}", "holds": i > 1 or None, "measured": "1", "expected": "1"} for i in range(18)]
    write_dump(tmp_path / "s.spool", samples()[0],
               meta={"verification": {"holds": True, "findings": claims}, "cost_per_sample": 1e-6,
                     "renderer": {"name": "numpy", "version": "1"}, "scene": {"name": "s", "sha256": "0" * 64}, "mode": "iid"})
    lines = shown(80, "info", "s.spool", folder=tmp_path)
    assert len(lines) <= 10 and max(map(len, lines)) <= 80
    assert "16 claims hold, 2 not known" in "\n".join(lines)
    assert len(shown(80, "info", "s.spool", "--all", folder=tmp_path)) > 25


def test_all_of_info_and_a_pixel_fit_80_columns():
    chess = os.path.join(os.path.dirname(__file__), "..", "..", "dumps", "tiny", "chess.spool")
    for words in (["info", "--all", chess], ["pixel", chess, "--at", "20,30", "--sampler", "uniform", "--spp", "8", "--filter", "directional"]):
        lines = [line for line in shown(80, *words) if not line.startswith("file")]
        assert len(lines) > 20 and [line for line in lines if len(line) > 80] == []
