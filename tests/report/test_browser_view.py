"""The page of `spool view` in Chromium: the slider replays, a pixel answers, nothing else is asked."""

import json
import os
import subprocess
import time
from urllib.parse import urlsplit

import pytest
from opened_page import WIDE, Opened, browser  # noqa: F401

PROGRAM = os.environ["SPOOL_PROGRAM"]


def program(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("view") / "s.spool"
    program("synth", "scene_s", "--size", "48x40", "--samples", "32", "--seed", "3", "-q", "-o", path)
    return path


class Live(Opened):
    """A page of the program itself; asking anybody else would be seen."""

    def __init__(self, browser, *words):  # noqa: F811
        self.process = subprocess.Popen([PROGRAM, "view", "--json", *map(str, words)], stdout=subprocess.PIPE, text=True)
        self.url = json.loads(self.process.stdout.readline())["url"]
        self.page = browser.new_context(viewport=WIDE).new_page()
        self.errors, self.addresses = [], []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)
        self.page.on("request", lambda request: self.addresses.append(request.url))
        self.page.goto(self.url)
        self.open_images()

    def wait(self, condition):
        """The page's policy lets nobody but the debugger evaluate text."""
        end = time.monotonic() + 60
        while not self.page.evaluate(condition):
            assert time.monotonic() < end, condition
            self.page.wait_for_timeout(50)

    def end(self):
        self.page.close()
        self.process.terminate()
        assert self.process.wait(timeout=20) == 143
        here = urlsplit(self.url).netloc
        assert all(address.startswith(self.url) or address.startswith(("data:", "blob:")) for address in self.addresses), here
        assert self.errors == []


@pytest.fixture
def live(browser, scene):  # noqa: F811
    page = Live(browser, scene)
    yield page
    page.end()


def touch(page, x, y):
    box = page.locator("#stage canvas").nth(1).bounding_box()
    page.mouse.click(box["x"] + (x + 0.5) / 48 * box["width"], box["y"] + (y + 0.5) / 40 * box["height"])


def text_of(live, what):
    return live.page.locator(what).text_content()



def test_the_slider_replays_and_a_touched_pixel_answers(live, scene, tmp_path):
    page = live.page
    assert "B: multiscale + directional" in text_of(live, "#stage")
    first, before = live.picture(1), text_of(live, "#budget-slider + output")
    page.locator("#budget-slider").evaluate("s => { s.value = 2; s.dispatchEvent(new Event('input')); }")
    live.wait("document.querySelector('#images').textContent.includes('multiscale + directional, 3 spp: ')")
    assert live.picture(1) != first and text_of(live, "#budget-slider + output") == "3 spp" != before
    touch(page, 12, 10)
    live.wait("document.querySelector('#pixel-panel').textContent.includes('Pixel 12, 10')")
    answer, = json.loads(program("pixel", scene, "--at", "12,10", "--sampler", "multiscale", "--spp", "3", "--filter", "directional",
                                 "--json"))
    panel = text_of(live, "#pixel-panel")
    assert f"B, multiscale + directional: the first {answer['taken']} of 32" in panel
    shape, = answer["footprint"]["shapes"]
    assert f"{len(answer['footprint']['taps'])} pixels" in panel and f"size {shape['size']}" in panel
    mean = page.evaluate("document.querySelector('.running').data.find(t => t.name === 'mean').y")
    assert mean == pytest.approx(answer["mean"], rel=1e-6)
    assert page.locator("canvas.weights").count() == 2


def test_a_slider_that_runs_ends_where_it_stops(live):
    live.page.locator("#budget-slider").evaluate(
        "s => { for (const v of [1, 4, 6, 2, 8, 5, 7]) { s.value = v; s.dispatchEvent(new Event('input')); } }")
    live.wait("document.querySelector('#images').textContent.includes('multiscale + directional, 8 spp: ')")
    assert text_of(live, "#budget-slider + output") == "8 spp"


def test_methods_and_layers_change_live_too(live):
    page = live.page
    samplers = page.locator("#viewer-b-sampler option").all_text_contents()
    filters = page.locator("#viewer-b-filter option").all_text_contents()
    page.select_option("#viewer-b-sampler", label="uniform")
    page.select_option("#viewer-b-filter", label="gaussian")
    live.wait("document.querySelector('#stage').textContent.includes('B: uniform + gaussian')")
    assert "multiscale" in samplers and "directional" in filters
    image = live.picture(1)
    page.get_by_role("button", name="density").click()
    page.wait_for_timeout(300)
    assert live.picture(1) != image


def test_a_report_that_is_served_answers_for_every_pixel(browser, scene, tmp_path):  # noqa: F811
    program("evaluate", scene, "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", "4,8", "--replicates", "2",
            "--seed", "9", "-o", tmp_path / "r", "-q")
    live = Live(browser, tmp_path / "r")
    try:
        touch(live.page, 31, 22)
        live.wait("document.querySelector('#pixel-panel').textContent.includes('Pixel 31, 22')")
        answer, = json.loads(program("pixel", scene, "--at", "31,22", "--evaluation-seed", "9", "--json"))
        mean = live.page.evaluate("document.querySelector('.running').data.find(t => t.name === 'mean').y")
        assert mean == pytest.approx(answer["mean"], rel=1e-6)
        live.page.get_by_role("link", name="Other budgets").click()
        live.open_images()
        live.wait("document.querySelector('#images').textContent.includes(' spp: ')")
    finally:
        live.end()
