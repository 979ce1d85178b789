"""Figures of `spool figure` as pages: text inside and apart, windows that show something, fonts of LaTeX."""

import shutil

import numpy as np
import pytest
from drawn_text import recorded, strays
from made_results import make_rows, write_images, write_results

pytest.importorskip("matplotlib", reason="SKIPPED: no matplotlib in this Python")

from tools.report.failure import Failure
from tools.report.figure import main
from tools.report.figure_layout import GAP, SMALLEST, lay_out
from tools.report.figure_text import WIDTHS, fitted, pyplot, significant
from tools.report.figure_windows import asked_windows, choose_windows, inside
from tools.report.metric_names import metric_name
from tools.report.result_images import Crop, dump_names, file_name_of

METHODS = ["uniform", "multiscale{alpha=0.8,epochs=4}", "exec:python3 most_uncertain.py", "ours", "mitchell", "a" * 90,
           "adaptive_sampling_by_variance_of_neighbours", "multiscale:paper{alpha=0.3,explore_fraction=0.25}"]
RECORDINGS = ["chess", "a_recording_of_the_breakfast_room_at_night", "s", "living-room-2", "x" * 60, "kitchen"]


def make(folder, samplers, recordings, budgets, size=(48, 40)):
    dumps = tuple(f"scenes/{name}.spool" for name in recordings)
    rows = make_rows(dumps=dumps, samplers=tuple(samplers), filters=("directional",), budgets=budgets, replicates=3, size=size)
    write_results(folder, rows)
    write_images(folder, rows, dump_names(list(dumps)), file_name_of)
    return folder


@pytest.mark.parametrize("methods, recordings, budgets, column, size, crops", [
    (1, 1, (4,), 1, (48, 40), ()), (3, 4, (4, 8), 1, (20, 64), ()), (8, 1, (2, 3, 4, 64, 1024), 1, (48, 40), ()),
    (3, 1, (8,), 2, (90, 30), ()), (8, 6, (2, 3, 4, 64, 1024), 2, (24, 24), ()), (8, 6, (8,), 1, (24, 24), ()),
    (1, 6, (4, 8), 1, (48, 40), ("0,0,48,12",)), (3, 2, (4,), 1, (90, 30), ("2,2,20,20", "60,5,25,8", "30,0,8,30")),
    (5, 3, (4,), 2, (20, 64), ("0,0,20,20", "3,40,10,24")), (5, 1, (8,), 2, (16, 128), ())])
def test_no_text_lies_outside_the_page_or_over_another(tmp_path, monkeypatch, methods, recordings, budgets, column, size, crops):
    found = recorded(monkeypatch)
    folder = make(tmp_path / "r", METHODS[:methods], RECORDINGS[:recordings], budgets, size)
    chosen = [f"--method={name} + directional" for name in METHODS[:methods]] + [f"--crops={crop}" for crop in crops]
    assert main([str(folder), "-o", str(tmp_path / "f"), "--column", str(column), *chosen]) == 0
    drawn = {text.get_text() for _, _, text, _ in found}
    assert any(f"relMSE at {budgets[-1]} samples per pixel" in text for text in drawn) and "reference" in drawn
    assert all(any(name[:7] in text for text in drawn) for name in METHODS[:methods])
    assert {figure.get_size_inches()[0] for figure, _, _, _ in found} == {WIDTHS[column]}
    assert strays(found) == []


def test_the_watch_notices_what_strays(monkeypatch, tmp_path):
    found = recorded(monkeypatch)
    figure = pyplot.figure(figsize=(2, 1))
    figure.text(0.5, 0.5, "one")
    figure.text(0.52, 0.5, "two")
    figure.text(0.99, 0.1, "three")
    figure.savefig(tmp_path / "x.pdf")
    assert [line.split(": ", 1)[1].split(":")[0] for line in strays(found)] == ["'one' over 'two'", "'three' outside 2.00 x 1.00"]


@pytest.mark.parametrize("width", WIDTHS.values())
@pytest.mark.parametrize("tiles", [2, 5, 9])
@pytest.mark.parametrize("aspect", [0.25, 1.0, 16 / 9, 4.0])
@pytest.mark.parametrize("shapes", [[1.0, 1.0], [0.25], [4.0, 1.0, 1.0, 0.5]])
def test_every_tile_has_a_place_inside_the_width(width, tiles, aspect, shapes):
    for with_maps in (False, True):
        layout = lay_out(width, 3.0, tiles, aspect, shapes, with_maps, 0.3, 0.3)
        assert [place for row in layout.rows for place in row] == list(range(tiles))
        first = layout.thumb[0] + 2 * GAP
        starts = [layout.start(i) for i in range(len(layout.rows))]
        assert layout.width <= width + 1e-6 and starts[0] >= first - 1e-6 and min(starts) >= -1e-6
        ends = [start + len(row) * (layout.tile + GAP) - GAP for start, row in zip(starts, layout.rows)]
        assert max(ends) <= layout.width + 1e-6 and max(ends) - min(ends) < 1e-6  # tiles stand below each other
        assert layout.is_even() or layout.size <= SMALLEST


def test_numbers_are_broken_between_and_not_within():
    figure = pyplot.figure(figsize=(2, 1))
    text, size = fitted(figure, "[2.38e-4, 2.43e-4]", 0.42, (7, 6.5), 2)
    assert text == "[2.38e-4,\n2.43e-4]"
    pyplot.close(figure)


def test_windows_are_where_methods_differ_on_something_and_apart():
    reference = np.full((120, 160, 3), 0.2)
    reference[20:50, 20:50] += 0.3 * (np.indices((30, 30)).sum(0) // 6 % 2)[..., None]  # structure, both methods alike
    reference[70:100, 100:130] += 0.3 * (np.indices((30, 30)).sum(0) // 6 % 2)[..., None]  # structure, they differ
    reference[0:30, 110:150] = 80.0  # a lamp: white whatever the method does
    noisy = reference.copy()
    noisy[60:110, 90:140] *= np.random.default_rng(1).uniform(0.3, 1.7, (50, 50, 1))
    noisy[60:115, 5:60] *= np.random.default_rng(2).uniform(0.3, 1.7, (55, 55, 1))  # they differ on a plain wall
    noisy[0:30, 110:150] *= 3.0
    first, second = choose_windows([reference, noisy], reference, 0.0)
    assert 60 < first.y + first.height / 2 < 110 and 90 < first.x + first.width / 2 < 140
    for window in (first, second):
        assert window.x > 0 and window.y > 0 and window.x + window.width < 160 and window.y + window.height < 120
    assert max(abs(first.x - second.x), abs(first.y - second.y)) > first.width  # they do not touch
    flat = np.full((16, 16, 3), np.nan)
    assert choose_windows([flat, flat], flat, 0.0) == [Crop(0, 0, 16, 16)] * 2  # nothing to choose from


@pytest.mark.parametrize("text, word", [
    ("1,2,3", "whole numbers"), ("nan,0,8,8", "whole numbers"), ("-1,0,8,8", "whole numbers"), ("0,0,0,8", "one pixel"),
    ("0,0,8,1e3", "whole numbers"), ("0,0,8,33", "4 times"), ("0,0,8,9999999999", "whole numbers"), ("", "whole numbers"),
    ("kitchen:0,0,8,8", "no recording kitchen"), ("a:b:0,0,8,0", "one pixel"), ("٣,0,8,8", "whole numbers")])
def test_a_window_that_is_none_is_named(text, word):
    with pytest.raises(Failure, match=word) as error:
        asked_windows([text], ["chess", "a:b"])
    assert "\n" not in str(error.value)


def test_asked_windows_are_shown_and_lie_inside(tmp_path, capsys):
    assert asked_windows(["1,2,8,8", "a:b:3,4,9,9", "5,6,8,8"], ["a:b"]) == {
        "": [Crop(1, 2, 8, 8), Crop(5, 6, 8, 8)], "a:b": [Crop(3, 4, 9, 9)]}
    with pytest.raises(Failure, match="1000 windows: give at most 4"):
        asked_windows(["0,0,8,8"] * 1000, [])
    assert inside([Crop(40, 32, 8, 8)], (40, 48), "chess")
    folder = make(tmp_path / "r", ["uniform"], ["chess", "s"], (4,))
    for crop in ("41,0,8,8", "s:0,33,8,8"):
        assert main([str(folder), "-o", str(tmp_path / "f"), "--crops", crop]) == 2
        assert "48 x 40 pixels" in capsys.readouterr().err and not (tmp_path / "f").exists()


def test_names_and_numbers_are_as_one_writes_them():
    names = ["relmse", "relmse_trimmed", "mse", "mae", "flip_ldr", "ssim", "my_error"]
    assert [metric_name(name) for name in names] == ["relMSE", "relMSE, trimmed", "MSE", "MAE", "FLIP", "SSIM", "my error"]
    numbers = {0.31: "0.310", 1.0: "1.00", 123.4: "123", 1234.0: "1234", 0.0: "0", 2.34e-5: "2.34e-5", 1.2e7: "1.20e7",
               -0.25: "-0.250", 0.9999: "1.00", 9.999: "10.0", 99.96: "100"}
    assert {number: significant(number) for number in numbers} == numbers


@pytest.mark.skipif(not (shutil.which("latex") and shutil.which("dvipng")), reason="SKIPPED: no LaTeX")
def test_text_set_by_latex_is_in_its_font_and_inside(tmp_path, monkeypatch, capsys):
    found = recorded(monkeypatch)
    folder = make(tmp_path / "r", ["uniform", r"a_b%&#${x}~^\d"], ["chess"], (4, 8))
    assert main([str(folder), "-o", str(tmp_path / "f"), "--font", "latex", "--column", "1"]) == 0, capsys.readouterr().err
    assert strays(found) == []
    assert all(b"/FontFile" in path.read_bytes() and b"STIX" not in path.read_bytes() for path in (tmp_path / "f").glob("*.pdf"))
    assert main([str(folder), "-o", str(tmp_path / "g"), "--font", "latex:nosuchpackage"]) == 2
    assert "nosuchpackage" in (error := capsys.readouterr().err) and error.count("\n") == 1


