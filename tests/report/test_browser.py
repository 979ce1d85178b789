"""The page in a headless Chromium with the network off: figures, table, charts, what it may not do."""

import csv
import json
import math
from collections import defaultdict

import pytest
from opened_page import PHONE, WIDE, Opened, browser, opened, report  # noqa: F401

from made_statistics import made_interval
from made_results import make_rows, write_results
from tools.report.report import main
from tools.report.statistics_file import Interval

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
    opened.open_charts()
    traces = page.locator("#budget-chart .scatterlayer .trace")
    assert traces.count() == 9
    page.get_by_role("checkbox", name="mitchell").uncheck()
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
    opened.open_charts()
    assert page.locator("#pareto-chart .point").count() == 27
    assert page.locator("#pareto-chart .errorbar").count() == 27
    assert page.locator("#pareto-chart .errorbar .xerror").count() == 27
    assert page.locator("#budget-chart .errorbar .yerror").count() == 27
    data = page.evaluate("JSON.parse(document.getElementById('report-data').textContent)")
    at = [q["name"] for q in data["quantities"]].index("relmse")
    bars = page.evaluate("document.getElementById('budget-chart').data.map(t => [t.name, t.customdata, t.y, "
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


@pytest.mark.parametrize("metric, cost", [("relmse", lambda v: v), ("psnr_tm", lambda v: -v), ("energy_ratio", lambda v: abs(math.log(v)))])
def test_the_front_is_of_what_is_better_in_the_metric(browser, tmp_path, metric, cost):
    rows = make_rows(dumps=("a.spool",), budgets=(4, 8))
    places = list(dict.fromkeys((row["sampler"], row["filter"], row["spp"]) for row in rows))
    for row in rows:
        i = places.index((row["sampler"], row["filter"], row["spp"]))
        row.update(seconds_total=repr(0.1 + 0.01 * i), psnr_tm=repr(20.0 + 5 * i % 7), energy_ratio=repr(0.7 + 0.03 * i))
    write_results(tmp_path, rows)
    better = [{"name": "psnr_tm", "better": "higher"}, {"name": "energy_ratio", "better": "near 1"}]
    (tmp_path / "words.json").write_text(json.dumps({"metrics": better}))
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html"), "--metric", metric, "--vocabulary", str(tmp_path / "words.json")]) == 0
    opened = Opened(browser, tmp_path / "report.html")
    opened.open_charts()
    front, *lines = opened.page.evaluate("document.getElementById('pareto-chart').data.map(t => t.x.map((x, i) => [x, t.y[i]]))")
    points = sorted(((x, cost(y)) for line in lines for x, y in line))
    wanted = [p for i, p in enumerate(points) if all(p[1] < q[1] for q in points[:i])]
    assert len(wanted) > 1 and [(x, cost(y)) for x, y in front] == wanted


def test_bars_at_one_budget_stand_beside_each_other_and_times_have_their_unit(opened):
    opened.open_charts()
    places = opened.page.evaluate("document.getElementById('budget-chart').data.filter(t => t.customdata).map(t => "
                                  "[t.x, t.customdata])")
    first = [x for xs, budgets in places for x, spp in zip(xs, budgets) if spp == budgets[0]]
    assert len(first) == 9 and len(set(first)) == 9 and max(first) / min(first) < 1.1
    axis = opened.page.evaluate("(({ticktext, tickvals}) => [ticktext, tickvals])("
                                "document.getElementById('pareto-chart')._fullLayout.xaxis)")
    if axis[0]:  # an axis shorter than a factor of two has plotly's own
        assert all(text.endswith(" s") and float(text[:-2]) == pytest.approx(value) for text, value in zip(*axis))
    else:
        assert opened.page.evaluate("document.getElementById('pareto-chart')._fullLayout.xaxis.title.text").endswith("s")


def test_an_axis_of_many_decades_has_few_short_labels(browser, tmp_path):
    write_results(tmp_path, make_rows(samplers=("uniform", "ours"), filters=("box",), budgets=(4, 8), factor={"ours": 1e-30}))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    opened.open_charts()
    texts, values = opened.page.evaluate("(({ticktext, tickvals}) => [ticktext, tickvals])(document.getElementById('budget-chart')._fullLayout.yaxis)")
    assert 8 <= len(texts) <= 13 and list(map(float, texts)) == pytest.approx(values, rel=1e-9) and max(map(len, texts)) <= 5


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
    opened.open_charts()
    assert opened.page.locator("#budget-chart .point").count() == 3
    assert "no value above zero: 1 of 4" in opened.page.locator("#charts").text_content()
    assert opened.page.locator("#budget-chart .errorbar").count() == 3
    assert opened.errors == []


def test_of_many_methods_the_first_are_drawn_until_all_are_asked_for(browser, tmp_path):
    write_results(tmp_path, make_rows(dumps=("a.spool",), filters=("box", *(f"f{i}" for i in range(7)))))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    opened.open_charts()
    names = opened.page.evaluate("document.getElementById('budget-chart').data.map(t => t.name)")
    ranked = opened.page.locator("#headline tbody th").all_text_contents()
    assert 12 <= len(names) <= 13 and set(names) == set(ranked), (names, ranked)
    opened.page.locator("#charts").get_by_role("button", name="all 24 methods").click()
    assert opened.page.locator("#budget-chart .scatterlayer .trace").count() == 24
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
