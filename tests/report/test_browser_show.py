"""The page of spool show, and cells of a notebook: flip, split, zoom, maps and values in Chromium, without a network."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from opened_page import WIDE, Opened, browser  # noqa: F401
from shown_pages import PACKAGE, cells, shown, write_exr

from test_browser_viewer import press, srgb

TREE = Path(__file__).resolve().parents[2]
NARROW = {"width": 600, "height": 800}
LONG = "a name that is longer than its pane is wide, " * 3
HOSTILE = "</script><img src=x onerror=alert(1)>\"'&`"
random = np.random.default_rng(4)
TRUTH = random.uniform(0.05, 1.0, (30, 40, 3)).astype(np.float32)


def noisy():
    return TRUTH * random.uniform(0.3, 1.7, TRUTH.shape).astype(np.float32)


def open_page(browser, path, **options):  # noqa: F811
    page = Opened(browser, path, **options)
    page.open_images()
    assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    return page


def captions(opened):
    return opened.page.locator("#stage figcaption").all_text_contents()


def done(opened, path):
    assert opened.errors == [] and all(a.startswith((path.as_uri(), "blob:", "data:")) for a in opened.addresses)
    opened.page.context.close()


def exposure_of(opened):
    return opened.page.evaluate("JSON.parse(document.getElementById('report-data').textContent).pictures.scenes[0].exposure")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("viewport", [WIDE, NARROW], ids=["wide", "narrow"])
@pytest.mark.parametrize("count", [1, 2, 8])
def test_every_image_has_a_pane(browser, tmp_path, count, viewport, scheme):  # noqa: F811
    images = {f"{i} {LONG}": noisy() for i in range(count)}
    path = shown(tmp_path, images, "--reference", write_exr(tmp_path / "r.exr", TRUTH))
    opened = open_page(browser, path, viewport=viewport, scheme=scheme)
    assert captions(opened) == [f"{i + 1}: {name}" for i, name in enumerate(images)] + ["reference"]
    boxes = [c.bounding_box() for c in opened.page.locator("#stage canvas").all()]
    assert len({(box["width"], box["height"]) for box in boxes}) == 1 and boxes[0]["width"] >= 200
    assert all(box["x"] + box["width"] <= viewport["width"] for box in boxes)
    places = {(box["x"], box["y"]) for box in boxes}
    assert len(places) == count + 1  # none over another
    exposure = exposure_of(opened)
    for pane, image in enumerate([*images.values(), TRUTH]):
        seen = opened.colour_at(20.5 / 40, 29.5 / 30, pane)
        assert np.abs(np.array(seen) - srgb(image[29, 20], exposure)).max() <= 2.0
    done(opened, path)


def test_keys_flip_through_all_and_split_takes_any_two(browser, tmp_path):  # noqa: F811
    images = {name: noisy() for name in ("first", "second", "third")}
    path = shown(tmp_path, images, "--reference", write_exr(tmp_path / "r.exr", TRUTH))
    opened = open_page(browser, path)
    for key, caption in (("2", "2: second"), ("3", "3: third"), ("r", "reference"), ("Space", "1: first"), ("Space", "2: second"),
                         ("4", "reference"), ("5", "reference")):
        press(opened.page, key)
        assert captions(opened) == [caption]
    opened.page.get_by_role("button", name="split").click()
    assert captions(opened) == ["1: first  |  2: second"]
    opened.page.select_option("#viewer-b", label="reference")
    opened.page.select_option("#viewer-a", label="third")
    opened.page.wait_for_timeout(100)
    assert captions(opened) == ["3: third  |  reference"]
    exposure = exposure_of(opened)
    for x, image in ((2, images["third"]), (37, TRUTH)):
        seen = opened.colour_at((x + 0.5) / 40, 0.5 / 30)
        assert np.abs(np.array(seen) - srgb(image[0, x], exposure)).max() <= 2.0
    done(opened, path)


def test_maps_values_zoom_and_exposure(browser, tmp_path):  # noqa: F811
    images = {"same": TRUTH, "other": noisy()}
    path = shown(tmp_path, images, "--reference", write_exr(tmp_path / "r.exr", TRUTH), "--crop", "3,4,20,5")
    opened = open_page(browser, path)
    page, first = opened.page, opened.picture(0)
    box = page.locator("#stage canvas").nth(0).bounding_box()
    page.mouse.move(box["x"] + 12.5 / 40 * box["width"], box["y"] + 7.5 / 30 * box["height"])
    said = page.locator("#pixel-values").text_content()
    assert said.startswith("x 12, y 7:") and said.count(" ".join(f"{v:.3g}" for v in TRUTH[7, 12])) == 2
    page.mouse.move(1, 1)
    press(page, "e")
    assert opened.picture(0) != first
    for name, zero in (("error", (0, 0, 4)), ("FLIP", (0, 0, 4)), ("difference", (247, 247, 247))):
        page.get_by_role("button", name=name, exact=True).click()
        page.wait_for_timeout(150)
        assert np.abs(np.array(opened.colour_at(0.9, 0.05, 0)) - zero).max() <= 1, name  # an image that equals the reference
        assert opened.picture(1) != opened.picture(0)
    assert page.locator("#insets canvas").count() == 3
    inset = page.locator("#insets canvas").first.bounding_box()
    assert inset["width"] / inset["height"] == pytest.approx(4, rel=0.05)
    before = opened.picture(1)
    press(page, "+")
    assert opened.picture(1) != before
    done(opened, path)


def test_odd_pictures_and_names_are_shown(browser, tmp_path):  # noqa: F811
    odd = TRUTH.copy()
    odd[0, 0], odd[0, 1, 1], odd[5, 5] = np.nan, np.inf, 1e30
    path = shown(tmp_path, {HOSTILE: odd, "<b>bold</b>": TRUTH}, "--title", HOSTILE)
    opened = open_page(browser, path)
    assert captions(opened) == [f"1: {HOSTILE}", "2: <b>bold</b>"] and opened.page.title() == HOSTILE
    for x in (0, 1):
        assert opened.colour_at((x + 0.5) / 40, 0.5 / 30, 0) == [255, 0, 200]
    exposure = exposure_of(opened)
    assert np.abs(np.array(opened.colour_at(20.5 / 40, 20.5 / 30, 0)) - srgb(TRUTH[20, 20], exposure)).max() <= 2.0
    done(opened, path)
    path = shown(tmp_path, {"one": np.full((1, 1, 3), 0.18)})
    opened = open_page(browser, path)
    assert captions(opened) == ["1: one"] and np.abs(np.array(opened.colour_at(0.5, 0.5)) - 118).max() <= 2
    assert opened.page.get_by_role("button", name="split").count() == 0  # nothing to compare with
    done(opened, path)


TWO_CELLS = """
a, b = np.full((20, 30, 3), 0.2), np.full((20, 30, 3), 0.6)
shown = [spool.show({"a": a, "b": b}, reference=a), spool.show({"c": b}), spool.Image((20, 30, 3))]
shown[2][:] = a
"""


# As strict as VS Code is with the outputs of notebooks; JupyterLab has no such policy.
STRICT = ("<meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; "
          "style-src 'unsafe-inline'; img-src https: http: data:; font-src https:; connect-src https:; child-src https: data:\">")


@pytest.mark.skipif(not PACKAGE, reason="no package spool in this build")
@pytest.mark.parametrize("policy", ["", STRICT], ids=["free", "strict"])
def test_two_cells_of_a_notebook_do_not_meet(browser, tmp_path, policy):  # noqa: F811
    html = cells(TWO_CELLS, tmp_path)
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><meta charset='utf-8'>{policy}<body id='images' style='width: 600px'>" + "".join(html), encoding="utf-8")
    opened = Opened(browser, path)
    first, second = opened.page.frame_locator("iframe").nth(0), opened.page.frame_locator("iframe").nth(1)
    for frame in (first, second):
        frame.locator("#stage[data-ready]").wait_for(timeout=60000)
    first.get_by_role("button", name="flip", exact=True).click()
    assert first.locator("#stage figcaption").all_text_contents() == ["1: a"]
    assert second.locator("#stage figcaption").all_text_contents() == ["1: c"]
    assert second.locator("#stage canvas").bounding_box()["width"] > 400
    assert opened.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgba(0, 0, 0, 0)"  # no style leaves a cell
    assert opened.page.locator("figure img").evaluate("image => image.naturalWidth") == 30
    # A frame may not reach the notebook around it.
    assert opened.page.frames[1].evaluate("() => { try { return parent.document.title } catch (error) { return error.name } }") == "SecurityError"
    done(opened, path)


@pytest.mark.skipif(not PACKAGE, reason="no package spool in this build")
def test_a_saved_notebook_opens_offline(browser, tmp_path):  # noqa: F811
    import json
    import os
    python = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "spool/docs-venv/bin/python"
    assert python.is_file(), "no jupytext: tools/dev.sh setup docs"
    (tmp_path / "dumps").symlink_to(TREE / "dumps")
    run = ("import sys, jupytext, nbclient, nbformat\nbook = jupytext.read(sys.argv[1])\n"
           "nbclient.NotebookClient(book, timeout=600, kernel_name='python3').execute()\nnbformat.write(book, 'done.ipynb')")
    subprocess.run([python, "-c", run, TREE / "docs/examples/first_evaluation.py"], cwd=tmp_path, check=True, timeout=800,
                   env={**os.environ, "PYTHONPATH": PACKAGE})
    book = json.loads((tmp_path / "done.ipynb").read_text(encoding="utf-8"))
    outputs = ["".join(output["data"]["text/html"]) for cell in book["cells"] for output in cell.get("outputs", [])
               if "text/html" in output.get("data", {})]
    path = tmp_path / "saved.html"
    path.write_text("<!doctype html><meta charset='utf-8'>" + "<hr>".join(outputs), encoding="utf-8")
    opened = Opened(browser, path)
    for frame in range(opened.page.locator("iframe").count()):
        opened.page.locator("iframe").nth(frame).scroll_into_view_if_needed()
        opened.page.frame_locator("iframe").nth(frame).locator("#stage[data-ready]").wait_for(timeout=60000)
    view = opened.page.frame_locator("iframe").nth(1)  # of the page with a slider
    view.locator("#budget-slider").evaluate("s => { s.value = 3; s.dispatchEvent(new Event('input')); }")
    view.get_by_text("B, multiscale + darker, 16 spp: relMSE").wait_for()
    text = opened.page.locator("body").inner_text()
    assert "verified" in text and "16 claims hold" in text and "multiscale + directional" in text
    assert opened.page.locator("iframe").count() == 2
    assert opened.page.locator("img").evaluate_all("images => images.every((image) => image.naturalWidth > 0)")
    done(opened, path)
