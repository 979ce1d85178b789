"""Any reader can use the page: colour-blind, with a keyboard, on a phone, on paper; with any number of methods and long names."""

import pytest
from made_results import make_rows, write_images, write_results
from opened_page import Opened, browser, opened, report  # noqa: F401

from tools.report.file_names import dump_names, file_name_of
from tools.report.report import main

LONG = "multiscale(levels=6,threshold=0.25,window=11,remainder=uniform,seed=7,keep=0.5)"
RECORDINGS = ("chess.spool", "a_recording_with_a_rather_long_name_of_the_scene_that_it_is_of.spool")


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """Eleven samplers, one with a long name, three filters, images."""
    folder = tmp_path_factory.mktemp("many")
    rows = make_rows(dumps=RECORDINGS, samplers=("uniform", LONG, *(f"m{i}" for i in range(9))), budgets=(4, 8), replicates=2)
    return made(folder, rows, images=True)


def made(folder, rows, images=False):
    write_results(folder, rows)
    if images:
        write_images(folder, rows, dump_names(dict.fromkeys(row["dump"] for row in rows)), file_name_of)
    assert main([str(folder), "-o", str(folder / "a.html")]) == 0
    return folder / "a.html"


def drawn(browser, page, width=1280, scheme="light"):  # noqa: F811
    """Without a scroll or a click."""
    found = Opened(browser, page, {"width": width, "height": 900}, scheme)
    for place in ("#stage[data-ready]", "#budget-chart .main-svg", ".crop canvas"):
        found.page.wait_for_selector(place, state="attached", timeout=60000)
    return found


@pytest.mark.parametrize("samplers, filters", [(2, 2), (11, 3), (30, 1), (1, 30)])
def test_methods_differ_in_what_is_drawn(browser, tmp_path, samplers, filters):  # noqa: F811
    rows = make_rows(dumps=("a.spool",), samplers=("uniform", *(f"s{i}" for i in range(1, samplers))),
                     filters=("box", *(f"f{i}" for i in range(1, filters))), budgets=(4,), replicates=2)
    page = Opened(browser, made(tmp_path, rows)).page
    page.wait_for_selector("#budget-chart .main-svg", state="attached")
    button = page.locator("#charts").get_by_role("button", name="all")
    if button.is_visible():
        button.click()
    # Colour, outline and dash, as the browser has them.
    marks = page.locator("#budget-chart .trace").evaluate_all("""traces => traces.map((trace) => {
        const point = trace.querySelector('.point'), {fill, stroke} = getComputedStyle(point);
        return [fill, stroke, point.getAttribute('d'), trace.querySelector('.js-line').style.strokeDasharray].join(' '); })""")
    assert len(set(marks)) == len(marks) == samplers * filters
    for chips, count in ((0, samplers), (1, filters)):
        assert len(set(page.locator(".chips").nth(chips).locator(".mark").evaluate_all("all => all.map((m) => m.innerHTML)"))) == count


CONTRASTS = """() => {
  const rgba = (text) => { const [r, g, b, a = 1] = text.match(/[\\d.]+/g).map(Number); return [r, g, b, a]; };
  const over = ([r, g, b, a], below) => [r, g, b].map((v, i) => a * v + (1 - a) * below[i]);
  const ground = (node) => node ? over(rgba(getComputedStyle(node).backgroundColor), ground(node.parentElement)) : [255, 255, 255];
  const light = (rgb) => rgb.map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0.05);
  const found = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !node.checkVisibility() || node.closest('script, option, .hoverlayer')) continue;
    const style = getComputedStyle(node), below = ground(node.closest('svg')?.parentElement ?? node);
    const [a, b] = [over(rgba(node.closest('svg') ? style.fill : style.color), below), below].map(light);
    found.push([Math.max(a, b) / Math.min(a, b), walker.currentNode.data, node.className]);
  }
  for (const input of document.querySelectorAll('[placeholder]')) {
    const [a, b] = [over(rgba(getComputedStyle(input, '::placeholder').color), ground(input)), ground(input)].map(light);
    found.push([Math.max(a, b) / Math.min(a, b), input.placeholder]);
  }
  return found;
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_from_its_ground(browser, tmp_path, scheme):  # noqa: F811
    # Ratios far below and above 1, and lost energy: cells of full colour.
    rows = make_rows(samplers=("uniform", "multiscale", "worse"), filters=("box", "directional"), budgets=(4,),
                     factor={"multiscale": 0.1, "directional": 0.5, "worse": 9.0})
    made(tmp_path, rows, images=True)
    file = tmp_path / "statistics.json"
    file.write_text(file.read_text().replace('"letters":', '"loses_energy": 0.03, "letters":'))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html"), "--force"]) == 0
    page = drawn(browser, tmp_path / "a.html", scheme=scheme).page
    assert "▼" in page.locator("#headline").text_content()
    page.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    found = page.evaluate(CONTRASTS)
    assert len(found) > 300 and not [f for f in found if f[0] < 4.5]


def test_every_cell_works_by_keyboard_and_says_its_interval_and_verdict(opened):  # noqa: F811
    page = opened.page
    page.locator("#headline thead button").last.focus()
    page.keyboard.press("Tab")
    for _ in range(30):
        name = page.evaluate("document.activeElement.getAttribute('aria-label') ?? ''")
        if name.startswith("mitchell + gaussian, kitchen"):
            break
        page.keyboard.press("Tab")
    assert name.startswith("mitchell + gaussian, kitchen") and "relMSE" in name and "[" in name and "than uniform + box" in name
    assert page.locator(".told").text_content() == name
    page.keyboard.press("Enter")
    page.locator("#stage figcaption", has_text="B: mitchell + gaussian").wait_for()
    assert page.locator("#viewer-scene option:checked").text_content() == "kitchen"
    assert page.evaluate("document.activeElement.id") == "viewer-scene"  # the next key is the viewer's


def test_every_chart_and_canvas_has_a_name(browser, many):  # noqa: F811
    page = drawn(browser, many).page
    names = page.locator("canvas, .chart").evaluate_all("all => all.map((n) => n.role === 'img' ? n.ariaLabel : null)")
    assert len(names) > 15 and all(names), names


# Texts and pictures beyond the page, or beyond the chart that they are in; tables scroll by themselves.
CUT = """(width) => [...document.querySelectorAll('body *')].filter((n) => n.checkVisibility() && !n.closest('.hoverlayer, .scroll') &&
  (n instanceof HTMLElement || n.matches('.legendtext')) &&
  n.getBoundingClientRect().right > (n.closest('.chart')?.getBoundingClientRect().right ?? width) + 1).map((n) => n.outerHTML.slice(0, 200))"""


@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_is_cut_by_long_names(browser, many, width):  # noqa: F811
    page = drawn(browser, many, width).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width and page.evaluate(CUT, width) == []
    for cell in page.locator("#headline tbody tr").first.locator("td").all()[:2]:
        box = cell.bounding_box()
        assert box["x"] > 0 and box["x"] + box["width"] <= width
    for table in page.locator("#headline, #results").all() if width == 1280 else ():
        assert table.evaluate("t => t.offsetWidth <= t.closest('.scroll').clientWidth")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_print_has_all_charts_and_pictures_on_white_and_no_controls(browser, many, scheme):  # noqa: F811
    opened = drawn(browser, many, scheme=scheme)  # noqa: F811
    page = opened.page
    page.evaluate("addEventListener('beforeprint', () => { window.printed = (window.printed ?? 0) + 1; })")
    page.pdf(format="A4")
    assert page.evaluate("window.printed") == 1  # the browser says so
    page.locator("#viewer-b-sampler").select_option(label=LONG)
    page.locator("#insets figcaption", has_text=LONG).first.wait_for()
    page.locator("details.columns").evaluate("d => { d.open = true; d.querySelectorAll('input').forEach((i) => i.checked || i.click()); }")
    before = page.locator("#pareto-chart").bounding_box()["width"]
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator(":is(select, input, nav, .modebar, button:not(.plain, .cell)):visible").count() == 0
    body = page.locator("body").bounding_box()
    assert body["width"] < 718  # A4 with margins of a centimetre
    right = body["x"] + body["width"]
    assert page.evaluate(CUT, right) == []
    for table in page.locator(".scroll table:visible").all():
        box = table.bounding_box()
        assert box["x"] + box["width"] <= right
    for chart in page.locator(".chart").all():
        box = chart.locator(".main-svg").first.bounding_box()
        assert box["width"] == body["width"] and box["x"] + box["width"] <= right
    assert page.locator("#hero-chart .js-line").first.evaluate("line => getComputedStyle(line).stroke") == "rgb(0, 114, 178)"
    assert page.locator("#stage canvas").count() == 3
    for canvas in page.locator("canvas:visible").all():
        assert canvas.evaluate("c => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v) => v > 0 && v < 255)")
        box = canvas.bounding_box()
        assert box["x"] + box["width"] <= right
    assert page.locator("figcaption:visible").evaluate_all("all => all.every((c) => c.scrollWidth <= c.clientWidth)")
    assert not [f for f in page.evaluate(CONTRASTS) if f[0] < 4.5]
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    page.wait_for_timeout(500)
    assert page.locator("#pareto-chart .main-svg").first.bounding_box()["width"] == pytest.approx(before, abs=1)
    assert opened.errors == []
