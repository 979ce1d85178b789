"""Pictures of the report and of the live page, docs/images/report*.png and view.png, from what `tools/dev.sh demo` made.

usage: ~/.cache/spool/browser-venv/bin/python -m tools.docs.page_pictures [demo-output] [-o docs/images]
Needs what the browser tests need (tools/dev.sh setup test).
"""

import argparse
import json
import shutil
import subprocess
from pathlib import Path

from playwright.sync_api import sync_playwright

PROGRAM, RECORDING = "build/release/spool", "dumps/cornell_box.spool"
DESK, TALL, PHONE = {"width": 1440, "height": 900}, {"width": 1440, "height": 1000}, {"width": 390, "height": 844}


def opened(browser, address, size, scheme="light"):
    page = browser.new_context(viewport=size, color_scheme=scheme).new_page()
    page.goto(address)
    page.mouse.move(0, 0)
    page.wait_for_timeout(2000)  # charts
    return page


def at_images(page):
    page.locator("#images").scroll_into_view_if_needed()
    page.wait_for_selector("#stage[data-ready]", timeout=60000)
    page.evaluate("document.querySelector('#images').scrollIntoView()")
    page.wait_for_timeout(1000)


def touch_pixel(page):
    """The darkest of those whose samples are in the page: few samples of it are bright."""
    data = json.loads(page.locator("#report-data").text_content())
    pixel, scene = min(data["pixels"][0]["answers"], key=lambda told: told["mean"][-1]), data["pictures"]["scenes"][0]
    box = page.locator("#stage canvas").first.bounding_box()
    page.mouse.click(box["x"] + (pixel["x"] + 0.5) / scene["width"] * box["width"],
                     box["y"] + (pixel["y"] + 0.5) / scene["height"] * box["height"])
    page.wait_for_timeout(1500)
    page.evaluate("scrollTo(0, document.querySelector('#pixel-panel').getBoundingClientRect().top + scrollY - 70)")
    page.wait_for_timeout(500)


def of_report(browser, address, folder):
    opened(browser, address, DESK).screenshot(path=folder / "report.png")
    opened(browser, address, PHONE).screenshot(path=folder / "report_phone.png")
    for name, scheme in (("report_viewer", "light"), ("report_dark", "dark")):
        page = opened(browser, address, TALL, scheme)
        at_images(page)
        if scheme == "dark":
            page.get_by_role("button", name="FLIP", exact=True).click()
            page.wait_for_timeout(500)
        page.screenshot(path=folder / f"{name}.png")
        if scheme == "light":
            touch_pixel(page)
            page.screenshot(path=folder / "report_pixel.png")


def of_view(browser, folder):
    """At 8 samples a pixel: A uniform samples as they are, B multiscale samples and the directional filter."""
    serving = subprocess.Popen([PROGRAM, "view", "--json", RECORDING], stdout=subprocess.PIPE, text=True)
    try:
        page = opened(browser, json.loads(serving.stdout.readline())["url"], TALL)
        at_images(page)
        slider = page.locator("#budget-slider")
        while (shown := slider.get_attribute("aria-valuetext")) != "8 spp":
            page.locator("#stage").press("]")
            while slider.get_attribute("aria-valuetext") == shown:
                page.wait_for_timeout(200)  # replayed
        page.evaluate("document.activeElement.blur()")
        page.wait_for_timeout(2000)
        page.screenshot(path=folder / "view.png")
    finally:
        serving.terminate()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("results", nargs="?", default="demo-output", type=Path)
    parser.add_argument("-o", "--output", default="docs/images", type=Path)
    asked = parser.parse_args()
    with sync_playwright() as s:
        browser = s.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        of_report(browser, (asked.results / "report.html").resolve().as_uri(), asked.output)
        of_view(browser, asked.output)
        browser.close()


if __name__ == "__main__":
    main()
