"""The pixel panel shows what the program said of a pixel, and which of its samples A and B took."""

import json
import stat

import numpy as np
import pytest
from made_results import make_rows, write_images, write_results
from opened_page import WIDE, Opened, browser  # noqa: F401

from tools.report.exr_image import read_exr
from tools.report.report import main
from tools.report.file_names import dump_names, file_name_of

ANSWER = {"x": 12, "y": 10, "capacity": 40, "recorded": list(range(40)), "samples": [[0.1 * i, 0.2, 0.05 * i] for i in range(40)],
          "mean": [0.5 + 0.01 * i for i in range(40)], "low": [None] + [0.3 + 0.01 * i for i in range(1, 40)],
          "high": [None] + [0.7 + 0.01 * i for i in range(1, 40)],
          "histogram": {"not_positive": 3, "edges": [0.1, 1.0, 10.0], "counts": [20, 17]}}


@pytest.fixture
def page(browser, tmp_path):  # noqa: F811
    recording = tmp_path / "a.spool"
    recording.write_bytes(b"")
    rows = make_rows(dumps=(str(recording),), samplers=("uniform", "multiscale"), filters=("box", "directional"), budgets=(4,))
    write_results(tmp_path / "r", rows)
    write_images(tmp_path / "r", rows, dump_names([str(recording)]), file_name_of)
    (tmp_path / "r" / "manifest.json").write_text(json.dumps(
        {"dumps": [{"path": str(recording)}], "plan": {"seed": 5, "order": "disjoint", "pieces_per_side": 1, "decision_split": False}}))
    program = tmp_path / "program"  # says the same of one pixel, and what it was asked
    program.write_text(f"#!/bin/sh\necho \"$@\" > '{tmp_path}/asked'\ncat '{tmp_path}/answer'\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    (tmp_path / "answer").write_text(json.dumps([ANSWER]))
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "a.html"), "--program", str(program)]) == 0
    opened = Opened(browser, tmp_path / "a.html", WIDE)
    opened.open_images()
    return opened


def touch(page, x, y):
    box = page.locator("#stage canvas").first.bounding_box()
    page.mouse.click(box["x"] + (x + 0.5) / 48 * box["width"], box["y"] + (y + 0.5) / 40 * box["height"])
    page.wait_for_timeout(700)


def test_a_touched_pixel_shows_its_samples_running_mean_and_histogram(page, tmp_path):
    asked = (tmp_path / "asked").read_text()
    assert asked.startswith("pixel --json --evaluation-seed 5") and "--at" in asked and asked.strip().endswith("a.spool")
    assert "round mark" in page.page.locator("#pixel-panel").text_content()
    touch(page.page, 12, 10)
    panel = page.page.locator("#pixel-panel")
    assert "Pixel 12, 10" in panel.text_content()
    counts = [int(read_exr(tmp_path / "r" / f"a_{name}_4spp" / "density.exr")["n"][10, 12])
              for name in ("uniform_box", "multiscale_directional")]
    for letter, n in zip("AB", counts):
        assert f"{letter}, " in panel.text_content() and f"the first {n} of 40" in panel.text_content()
    lines = page.page.evaluate("document.querySelector('.running').data.map(t => [t.name, t.y])")
    assert dict((name, y) for name, y in lines if name == "mean")["mean"] == pytest.approx(ANSWER["mean"])
    truth = read_exr(tmp_path / "r" / "a_reference.exr")
    luminance = sum(w * float(truth[c][10, 12]) for w, c in zip((0.2126, 0.7152, 0.0722), "RGB"))
    assert dict((n, y) for n, y in lines if n == "reference")["reference"][0] == pytest.approx(luminance, rel=2e-3)
    bars = page.page.evaluate("(({y}) => y)(document.querySelector('.histogram').data[0])")
    assert bars == [20, 17] and page.page.evaluate("document.querySelector('.histogram').layout.xaxis.type") == "log"
    assert np.array(page.page.locator("canvas.samples").evaluate("c => [c.width, c.height]")).tolist() == [40 * 14, 24]
    assert page.errors == []


def test_enter_touches_the_pixel_in_the_middle(page):
    page.page.locator("#stage").focus()
    page.page.keyboard.press("Enter")
    page.page.wait_for_timeout(300)
    assert "x 24, y 20:" in page.page.locator("#pixel-values").text_content()
    for key in (*"+" * 5, *["ArrowLeft"] * 20, *["ArrowUp"] * 20, "Enter"):  # to the corner, three times as large
        page.page.keyboard.press(key)
    page.page.wait_for_timeout(300)
    assert "x 7, y 6:" in page.page.locator("#pixel-values").text_content()
    assert page.errors == []


def test_a_pixel_without_samples_says_where_to_ask(page):
    touch(page.page, 40, 35)
    assert "spool pixel FILE --at X,Y" in page.page.locator("#pixel-panel").text_content()
    touch(page.page, 12, 10)
    assert page.page.locator(".running").count() == 1
    assert page.errors == []
