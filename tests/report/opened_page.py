"""A page opened in a headless Chromium with the network off, and the fixtures of the browser tests."""

import hashlib
import os
import shutil

import pytest
from playwright.sync_api import sync_playwright

from tools.report.report import main

WIDE, PHONE = {"width": 1400, "height": 900}, {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as s:
        program = shutil.which(os.environ.get("SPOOL_CHROMIUM", "chromium"))
        browser = s.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def report(made_folder, tmp_path_factory):
    output = tmp_path_factory.mktemp("page") / "report.html"
    assert main([str(made_folder), "-o", str(output)]) == 0
    return output


class Opened:
    def __init__(self, browser, path, viewport=WIDE, scheme="light"):
        context = browser.new_context(offline=True, viewport=viewport, color_scheme=scheme)
        self.page = context.new_page()
        self.errors, self.addresses = [], []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda message: self.errors.append(message.text)
                     if message.type == "error" else None)
        self.page.on("request", lambda request: self.addresses.append(request.url))
        self.page.goto(path.as_uri())

    def open_charts(self):
        """They are drawn when they come into view."""
        self.page.locator("#charts").scroll_into_view_if_needed()
        self.page.wait_for_selector("#budget-chart .main-svg", state="attached", timeout=60000)

    def open_images(self):
        self.page.locator("#images").scroll_into_view_if_needed()
        self.page.wait_for_selector("#stage[data-ready]", timeout=60000)

    def picture(self, pane=0):
        """Hash of the pixels of a pane."""
        return hashlib.sha256(self.page.locator("#stage canvas").nth(pane)
                              .evaluate("canvas => canvas.toDataURL()").encode()).hexdigest()

    def colour_at(self, x, y, pane=0):
        """RGB of a pane at a place from 0 to 1."""
        return self.page.locator("#stage canvas").nth(pane).evaluate(
            "(c, [x, y]) => [...c.getContext('2d').getImageData(x * c.width, y * c.height, 1, 1).data].slice(0, 3)", [x, y])


@pytest.fixture
def opened(browser, report):
    return Opened(browser, report)
