"""The first screen: the table, chart, crops and sentences are what statistics.json says; its buttons save files."""

import csv
import io
import json
import math

import pytest
from made_results import make_rows, write_images, write_results
from opened_page import Opened, browser, opened, report  # noqa: F401

from tools.report.file_names import dump_names, file_name_of
from tools.report.report import main


@pytest.fixture
def statistics(made_folder):
    return json.loads((made_folder / "statistics.json").read_text())


def cells(page):
    """{method: [(text, ratio, verdict)] by recording}"""
    rows = page.locator("#headline tbody tr").evaluate_all(
        "rows => rows.map(r => [r.cells[0].textContent, [...r.cells].slice(1).map("
        "c => [c.textContent, c.dataset.ratio, c.dataset.verdict, c.style.background])])")
    return dict(rows)


def conditions_at(statistics, spp):
    return [c for c in statistics["conditions"] if (c["metric"], c["spp"]) == ("relmse", spp)]


def name_of(entry):
    return f"{entry['sampler']} + {entry['filter']}"


@pytest.mark.parametrize("spp", [4, 8, 16])
def test_the_table_says_ratio_letters_verdict_and_energy_of_the_file(opened, statistics, spp):
    page = opened.page
    page.locator("#headline-area select").first.select_option(label=str(spp))
    found = cells(page)
    for place, condition in enumerate(conditions_at(statistics, spp)):
        for entry in condition["ranking"]:
            text, ratio, verdict, colour = found[name_of(entry)][place]
            assert entry["letters"] in text
            assert ("▼" in text) == ("loses_energy" in entry)
            if "ratio" in entry:
                assert float(ratio) == pytest.approx(entry["ratio"][0], rel=1e-6)
                assert float(text.split()[0]) == pytest.approx(entry["ratio"][0], rel=6e-3)
                assert verdict == entry["against_baseline"]
                blue = colour.startswith("rgba(38")
                assert blue == (entry["ratio"][0] < 1)


def test_what_has_no_verdict_has_neither_colour_nor_bar_and_what_is_biased_says_so(browser, made_folder, statistics, tmp_path):
    for name in ("results.csv", "statistics.json"):
        (tmp_path / name).write_bytes((made_folder / name).read_bytes())
    for condition in statistics["conditions"]:
        condition["biased"] = True
        for entry in condition["ranking"]:
            if entry["filter"] == "gaussian":
                entry.update(compared=False, withheld="few pixels", letters="", against_baseline="not compared", value=entry["value"][:1])
                entry.pop("against_best", None)
    for result in statistics["results"]:
        if result["filter"] == "gaussian":
            result["quantities"]["relmse"] = result["quantities"]["relmse"][:1]
    (tmp_path / "statistics.json").write_text(json.dumps(statistics))
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html")]) == 0
    page = Opened(browser, tmp_path / "report.html").page
    for name, row in cells(page).items():
        for text, _, verdict, colour in row[:2]:
            assert ("‡" in text) == (verdict == "not compared") == ("gaussian" in name)
            assert colour == "transparent" or "gaussian" not in name
    bars = page.evaluate("document.getElementById('hero-chart').data.map((t) => [t.name, t.error_y.array.every(Number.isNaN)])")
    assert {name for name, none in bars if none} == {name for name, _ in bars if "gaussian" in name} != set()
    assert page.locator("#summary .biased").count() == 1 and "relMSE (biased)" in page.locator(".hero h3").text_content()
    assert saved(page, page.get_by_role("button", name="LaTeX", exact=True).click)[1].count("relMSE (biased)") == 1


def test_a_ratio_reads_one_only_where_it_is_one(browser, made_folder, statistics, tmp_path):
    """In the headline, in the words of its cells and in the table of all results."""
    (tmp_path / "results.csv").write_bytes((made_folder / "results.csv").read_bytes())
    for condition in statistics["conditions"]:
        for entry in condition["ranking"]:
            if "ratio" in entry:
                entry.update(ratio=[1.00041, 1.00021, 1.00061], against_baseline="worse")
    (tmp_path / "statistics.json").write_text(json.dumps(statistics))
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html")]) == 0
    page = Opened(browser, tmp_path / "report.html").page
    compared = [cell for row in cells(page).values() for cell in row if cell[2] == "worse"]
    assert compared and all(cell[0].startswith("1.0004") for cell in compared)
    assert "ratio 1.0004 [1.0002, 1.001]" in page.locator("#headline td.worse button").first.get_attribute("title")
    assert page.locator("#results td", has_text="1.0004[1.0002, 1.001]").count() > 0


def test_without_a_baseline_ratios_are_to_the_first_method(browser, tmp_path):
    write_results(tmp_path, make_rows(dumps=("a.spool",), samplers=("mitchell", "multiscale"), filters=("box", "gaussian"), budgets=(8,)))
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html")]) == 0
    page = Opened(browser, tmp_path / "report.html").page
    found = cells(page)
    assert [row[0][2] for row in found.values()].count("baseline") == 1 and float(found["mitchell + box"][0][1]) > 2
    assert "uniform" not in page.locator("#summary").text_content().split("How to read")[0]


def test_what_is_nearest_to_one_comes_first_where_that_is_best(browser, tmp_path):
    energies = {"mitchell": 1.05, "multiscale": 0.8, "uniform": 0.97}
    rows = make_rows(filters=("box",), budgets=(8,))
    for row in rows:
        row["energy_ratio"] = repr(energies[row["sampler"]])
    write_results(tmp_path, rows)
    (tmp_path / "words.json").write_text(json.dumps({"metrics": [{"name": "energy_ratio", "better": "near 1"}]}))
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html"), "--metric=energy_ratio", "--vocabulary", str(tmp_path / "words.json")]) == 0
    page = Opened(browser, tmp_path / "report.html").page
    assert list(cells(page)) == ["uniform + box", "mitchell + box", "multiscale + box"]
    assert "below 1 is better" not in page.locator("#headline-area").text_content()


def test_crops_show_one_method_once(browser, tmp_path):
    rows = make_rows(dumps=("a.spool",), samplers=("uniform",), filters=("box",), budgets=(8,))
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(["a.spool"]), file_name_of)
    assert main([str(tmp_path), "-o", str(tmp_path / "report.html")]) == 0
    page = Opened(browser, tmp_path / "report.html").page
    page.wait_for_selector(".crop canvas")
    page.wait_for_timeout(500)
    names = page.locator(".crop small").all_text_contents()
    assert names == ["a", *["uniform + box", "reference"] * ((len(names) - 1) // 2)]


def test_another_baseline_takes_the_pairs_of_the_file(opened, statistics):
    page = opened.page
    page.locator("#headline-area select").first.select_option(label="8")
    page.locator("#headline-area select").nth(1).select_option(label="mitchell + gaussian")
    found = cells(page)
    told = 0
    for place, condition in enumerate(conditions_at(statistics, 8)):
        names = [name_of(e) for e in condition["ranking"]]
        other = names.index("mitchell + gaussian")
        for a, b, ratio, low, high, _, verdict in condition["pairs"]:
            if other not in (a, b):
                continue
            mine = names[b if a == other else a]
            if b != other:
                ratio, verdict = 1 / ratio, {"better": "worse", "worse": "better"}.get(verdict, verdict)
            assert float(found[mine][place][1]) == pytest.approx(ratio, rel=1e-4)
            assert found[mine][place][2] == verdict
            told += verdict != "undecided"
    assert told > 8


def test_at_most_five_sentences_and_each_is_of_the_file(opened, statistics):
    texts = opened.page.locator(".leading li").all_text_contents()
    assert 1 <= len(texts) <= 5
    assert sum("has the lowest error" in t or "comes first" in t for t in texts) == 2  # one a recording
    lost = sum(any("loses_energy" in e for e in [entry]) for c in statistics["conditions"] if c["metric"] == "relmse"
               for entry in c["ranking"])
    assert (f"{lost} of 54 combinations lose light" in texts[-1]) == (lost > 0)


def test_chart_and_crops_stand_on_the_first_screen(opened):
    page = opened.page
    assert page.locator("#hero-chart .scatterlayer .trace").count() == 6
    page.wait_for_selector(".crop canvas")
    page.wait_for_timeout(500)
    assert page.locator(".crop").count() == 2 and page.locator(".crop canvas").count() == 8
    words = page.locator(".crop").first.text_content()
    assert "uniform + box" in words and "multiscale + directional" in words and "reference" in words
    page.locator("#headline thead button", has_text="kitchen").click()
    assert "kitchen" in page.locator(".hero h3").text_content()


def test_a_click_on_a_cell_shows_its_pictures(opened):
    page = opened.page
    page.locator("#headline tbody tr", has_text="mitchell + gaussian").locator("td").nth(1).click()
    page.wait_for_selector("#stage[data-ready]")
    page.wait_for_timeout(300)
    assert page.locator("#stage figcaption").nth(1).text_content() == "B: mitchell + gaussian"
    assert page.locator("#viewer-scene option:checked").text_content() == "kitchen"


def saved(page, click):
    with page.expect_download() as waiting:
        click()
    with open(waiting.value.path(), encoding="utf-8") as file:
        return waiting.value.suggested_filename, file.read()


def test_buttons_save_csv_latex_and_svg_without_a_request(opened, statistics):
    page = opened.page
    name, text = saved(page, page.get_by_role("button", name="CSV", exact=True).first.click)
    rows = list(csv.reader(io.StringIO(text)))
    assert name == "headline.csv" and rows[0][0] == "method, relMSE" and len(rows) == 10
    values = {row[0]: row[1] for row in rows[1:]}
    for entry in conditions_at(statistics, 16)[0]["ranking"]:
        assert float(values[name_of(entry)].split()[0]) == pytest.approx(entry["value"][0], rel=6e-3)
    name, text = saved(page, page.get_by_role("button", name="LaTeX", exact=True).click)
    assert name == "headline.tex" and text.count(r"\\") == 10 and text.count("{") == text.count("}")
    alone = sum(all(e.get("against_best") == "worse" for e in c["ranking"][1:]) for c in conditions_at(statistics, 16))
    assert text.count(r"\textbf") == alone
    opened.open_charts()
    name, text = saved(page, page.locator("#charts").get_by_role("button", name="SVG").first.click)
    assert name == "error_time.svg" and text.startswith("<svg") and "relMSE" in text
    name, text = saved(page, page.locator("#table").get_by_role("button", name="CSV").click)
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == 54 and math.isfinite(float(rows[0]["relmse_low"]))
    assert {address.split(":", 1)[0] for address in opened.addresses} <= {"file", "data", "blob"}
    assert opened.errors == []


def test_no_button_of_the_page_makes_a_request_or_an_error(opened):
    """Every button, once: nothing leaves the page."""
    page = opened.page
    opened.open_images()
    page.evaluate("void (window.open = () => { window.escaped = true; })")
    for i in range(page.locator("button, .modebar-btn").count()):
        button = page.locator("button, .modebar-btn").nth(i)
        if button.is_visible():
            button.click(force=True)
    page.wait_for_timeout(500)
    assert page.evaluate("window.escaped") is None
    assert {address.split(":", 1)[0] for address in opened.addresses} <= {"file", "data", "blob"}
    assert opened.errors == []
