"""The page in a headless Chromium with the network off."""

import csv
import hashlib
import json
import os
import shutil
from collections import defaultdict

import pytest
from playwright.sync_api import sync_playwright

from made_statistics import made_interval
from made_results import make_rows, write_results
from report import main
from statistics_file import Interval

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

    def open_images(self):
        self.page.locator("#images").scroll_into_view_if_needed()
        self.page.wait_for_selector("#book .flip[data-ready]", timeout=60000)
        self.page.wait_for_timeout(500)  # FlipBook paints every 100 ms

    def picture(self):
        """Hash of the pixels of the page that is turned up."""
        return hashlib.sha256(self.page.locator("#book canvas").locator("visible=true").first
                              .evaluate("canvas => canvas.toDataURL()").encode()).hexdigest()


@pytest.fixture
def opened(browser, report):
    return Opened(browser, report)


@pytest.mark.parametrize("viewport", [WIDE, PHONE], ids=["wide", "phone"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_opens_without_errors_network_or_sideways_scrolling(browser, report, viewport, scheme):
    opened = Opened(browser, report, viewport, scheme)
    opened.open_images()
    assert opened.errors == []
    assert {address.split(":", 1)[0] for address in opened.addresses} <= {"file", "data", "blob"}
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
    ground = opened.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, ground[4:-1].split(","))) > 382) == (scheme == "light")
    assert opened.page.locator(".warning", has_text="cannot be shown").count() == 0


def test_the_figures_are_those_of_statistics_json(opened, made_folder):
    values = defaultdict(list)
    with (made_folder / "results.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            key = row["dump"].split("/")[1].split(".")[0], row["sampler"], row["filter"], row["spp"]
            values[key].append(float(row["relmse"]))
    column = column_of(opened.page, "relmse")
    rows = opened.page.locator("#results tbody tr").all()
    assert len(rows) == len(values) == 54
    for row in rows:
        cells = row.locator("td").all_text_contents()
        expected = Interval(*made_interval(values[tuple(cells[:4])]))
        mean, interval = cells[column].rstrip("]").split("[")
        low, high = interval.split(", ")
        for text, value in ((mean, expected.mean), (low, expected.low), (high, expected.high)):
            assert float(text) == pytest.approx(value, rel=6e-4)
        exact = float(row.locator("td").nth(column).get_attribute("data-sort"))
        assert exact == pytest.approx(expected.mean, rel=1e-6)


def column_of(page, name):
    return page.locator("#results thead th").all_text_contents().index(name)


def numbers_of(page, name):
    at = column_of(page, name) + 1
    cells = page.locator(f"#results tbody tr:not([hidden]) td:nth-child({at})").all()
    return [float(cell.get_attribute("data-sort") or "inf") for cell in cells]


def test_a_click_and_enter_sort_the_table(opened):
    page = opened.page
    header = page.get_by_role("region", name="All results").get_by_role("columnheader", name="relmse", exact=True)
    header.click()
    numbers = numbers_of(page, "relmse")
    assert numbers == sorted(numbers) and header.get_attribute("aria-sort") == "ascending"
    header.press("Enter")
    numbers = numbers_of(page, "relmse")
    assert numbers == sorted(numbers, reverse=True) and numbers[0] > numbers[-1]
    page.get_by_role("region", name="All results").get_by_role("columnheader", name="spp", exact=True).click()
    assert numbers_of(page, "spp") == sorted(numbers_of(page, "spp"))  # 4, 8, 16: as numbers


def test_words_and_choices_filter_table_and_charts(opened):
    page = opened.page
    page.get_by_label("Show rows that hold these words").fill("kitchen DIRECTIONAL 8spp")
    rows = page.locator("#results tbody tr:not([hidden])")
    assert rows.count() == 3
    assert all("kitchen" in t and "directional" in t for t in rows.all_text_contents())
    page.get_by_label("Show rows that hold these words").fill("")
    traces = page.locator("#budget-chart .scatterlayer .trace")
    assert traces.count() == 9
    page.get_by_label("mitchell").uncheck()
    assert rows.count() == 36 and traces.count() == 6
    assert "36 of 54" in page.locator("#row-count").text_content()


def test_another_column_can_be_shown_and_keeps_the_order(opened):
    page = opened.page
    page.get_by_role("region", name="All results").get_by_role("columnheader", name="relmse", exact=True).click()
    page.locator("details.columns > summary").click()
    page.get_by_role("checkbox", name="psnr_tm").check()
    assert "psnr_tm" in page.locator("#results thead th").all_text_contents()
    numbers = numbers_of(page, "relmse")
    assert numbers == sorted(numbers)


def test_charts_have_points_and_asymmetric_error_bars_where_the_data_say(opened, report):
    page = opened.page
    assert page.locator("#pareto-chart .point").count() == 27
    assert page.locator("#pareto-chart .errorbar").count() == 27
    assert page.locator("#pareto-chart .errorbar .xerror").count() == 27
    assert page.locator("#budget-chart .errorbar .yerror").count() == 27
    data = page.evaluate("JSON.parse(document.getElementById('report-data').textContent)")
    at = [q["name"] for q in data["quantities"]].index("relmse")
    bars = page.evaluate("document.getElementById('budget-chart').data.map(t => [t.name, t.x, t.y, "
                         "t.error_y.array, t.error_y.arrayminus])")
    wanted = {(f"{data['samplers'][c['sampler']]} + {data['filters'][c['filter']]}", c["spp"]): c["values"][at]
              for c in data["combinations"] if c["dump"] == 0}
    seen = 0
    for name, xs, ys, above, below in bars:
        for x, y, up, down in zip(xs, ys, above, below):
            mean, low, high = wanted[name, x]
            assert y == mean and y + up == pytest.approx(high) and y - down == pytest.approx(low)
            seen += 1
    assert seen == 27
    axes = page.evaluate("[...'xy'].map(a => document.getElementById('pareto-chart')._fullLayout[a + 'axis'].type)")
    assert axes == ["log", "log"]


def test_keys_turn_pages_and_change_exposure(opened):
    opened.open_images()
    page = opened.page
    assert page.locator("#book canvas").count() == 10  # of uniform + box and multiscale + directional
    page.locator("#book [role=application]").focus()
    pictures = []
    for digit in range(1, 10):
        page.keyboard.press(str(digit))
        page.wait_for_timeout(50)
        pictures.append(opened.picture())
    assert len(set(pictures)) == 9  # all pages differ, among them the difference A - B
    page.keyboard.press("1")
    page.wait_for_timeout(50)
    assert opened.picture() == pictures[0]
    page.keyboard.press("e")
    page.wait_for_timeout(400)
    assert opened.picture() != pictures[0]
    page.keyboard.press("ArrowRight")
    page.wait_for_timeout(50)
    assert opened.picture() != pictures[1]  # exposure is shared: B is brighter too


def test_pages_show_the_values_of_the_exr_files(opened, made_folder):
    import numpy as np
    from exr_image import read_exr, rgb
    opened.open_images()
    drawn = opened.page.locator("#book canvas").nth(2).evaluate(
        "c => [...c.getContext('2d').getImageData(0, 0, c.width, c.height).data]")
    image = rgb(read_exr(made_folder / "chess_reference.exr"))
    drawn = np.array(drawn).reshape(*image.shape[:2], 4)[..., :3]
    data = opened.page.evaluate("JSON.parse(document.getElementById('report-data').textContent)")
    exposed = np.clip(image * 2.0 ** data["pictures"]["scenes"][0]["exposure"], 0.0, 1.0)
    srgb = np.where(exposed <= 0.0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - 0.055)
    assert np.abs(drawn - 255.0 * srgb).max() <= 2.0


def test_one_book_at_a_time_and_its_timers_end_with_it(opened):
    opened.open_images()
    page = opened.page
    page.evaluate("window.running = new Set(); const start = window.setInterval, stop = window.clearInterval;"
                  "window.setInterval = (...a) => { const id = start(...a); running.add(id); return id; };"
                  "window.clearInterval = (id) => { running.delete(id); stop(id); };")
    counts = []
    for i in range(4):
        page.locator("#image-area select").nth(2).select_option(str(i))
        page.wait_for_selector("#book .flip[data-ready]", timeout=60000)
        assert page.locator("#book .flip").count() == 1
        assert page.locator("#book canvas").count() <= 12
        counts.append((page.evaluate("running.size"), page.locator("#book canvas").count()))
    assert all(running == canvases for running, canvases in counts[1:])
    assert opened.errors == []


def test_a_finger_drags_the_picture(browser, report):
    context = browser.new_context(offline=True, viewport=PHONE, has_touch=True)
    page = context.new_page()
    page.goto(report.as_uri())
    page.locator("#images").scroll_into_view_if_needed()
    page.wait_for_selector("#book .flip[data-ready]", timeout=60000)
    canvas = page.locator("#book canvas").first
    before = canvas.bounding_box()
    canvas.evaluate("""canvas => {
      const touch = (x, y) => new Touch({identifier: 1, target: canvas, clientX: x, clientY: y});
      const send = (name, t) => canvas.dispatchEvent(new TouchEvent(name, {bubbles: true, cancelable: true, touches: t}));
      send('touchstart', [touch(100, 100)]); send('touchmove', [touch(130, 145)]); send('touchend', []);
    }""")
    page.wait_for_timeout(200)
    after = canvas.bounding_box()
    assert (after["x"] - before["x"], after["y"] - before["y"]) == (30, 45)


def test_the_tab_key_reaches_the_charts_controls_before_the_images(opened):
    opened.open_images()
    assert opened.page.locator("[tabindex]").evaluate_all(
        "nodes => nodes.filter(n => n.tabIndex > 0).length") == 0


def test_errors_at_zero_are_left_out_of_the_chart_and_counted(browser, tmp_path):
    rows = make_rows(dumps=("a.spool",), samplers=("uniform",), filters=("box", "gaussian"), budgets=(4, 8))
    for row in rows:
        if row["filter"] == "gaussian" and row["spp"] == "8":
            row["relmse"] = repr(-1e-4 - 1e-6 * int(row["replicate"]))
        if row["filter"] == "box" and row["spp"] == "8":
            row["relmse"] = repr(0.01 * (1 + 2.0 * (int(row["replicate"]) - 2)))
    write_results(tmp_path, rows)
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    assert opened.page.locator("#budget-chart .point").count() == 3
    assert "no value above zero: 1 of 4" in opened.page.locator("#charts").text_content()
    assert opened.page.locator("#budget-chart .errorbar").count() == 3
    assert opened.errors == []


def test_hostile_names_do_nothing(browser, tmp_path):
    hostile = '</script><script>window.hit=1</script><img src=x onerror="window.hit=1"><b>bold</b>'
    write_results(tmp_path, make_rows(dumps=(f"{hostile}.spool", "b.spool"), samplers=("uniform", hostile), budgets=(4, 8)))
    (tmp_path / "manifest.json").write_text(json.dumps({"command": hostile}))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html"), "--title", hostile]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    assert opened.page.evaluate("window.hit") is None
    assert opened.page.locator("main img, #results b").count() == 0
    assert hostile in opened.page.locator("#results").text_content()
    assert hostile in opened.page.locator("h1").text_content()
    assert opened.errors == []


def test_no_button_sends_figures_away(opened):
    """The chart library's own server and its button are off: the page makes no connection."""
    titles = opened.page.locator(".modebar-btn").evaluate_all("all => all.map(b => b.dataset.title || '')")
    assert titles and not [t for t in titles if "loud" in t or "hare" in t or "tudio" in t], titles
    assert opened.page.locator(".modebar-btn--logo").count() == 0
    assert opened.page.evaluate("[...document.querySelectorAll('.js-plotly-plot')].map(p => p._context.plotlyServerURL)"
                                ".join('')") == ""


def test_without_images_the_page_says_so(browser, tmp_path):
    write_results(tmp_path, make_rows())
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    assert "No images were written" in opened.page.locator("#images").text_content()
    assert opened.errors == []


def test_ten_thousand_results_sort_and_filter(browser, tmp_path):
    write_results(tmp_path, make_rows(
        dumps=[f"s{i}.spool" for i in range(10)], samplers=list("abcde"), filters=list("vwxyz"),
        budgets=(2, 4, 8, 16, 32, 64, 96, 128)))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    assert opened.page.locator("#results tbody tr").count() == 2000
    opened.page.get_by_role("region", name="All results").get_by_role("columnheader", name="relmse", exact=True).click()
    column = column_of(opened.page, "relmse")
    numbers = opened.page.evaluate(
        f"[...document.querySelectorAll('#results tbody tr')].map(r => Number(r.cells[{column}].dataset.sort))")
    assert numbers == sorted(numbers)
    opened.page.get_by_label("Show rows that hold these words").fill("s3 c x 16spp")
    assert opened.page.locator("#results tbody tr:not([hidden])").count() >= 1
    assert opened.errors == []
