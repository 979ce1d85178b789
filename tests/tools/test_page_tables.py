"""Tables of a generated page become CSV files and plots; prose, verdicts and short tables stay."""
import csv
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
from page_tables import SHORT, take_apart  # noqa: E402
from whole_file import write_whole  # noqa: E402

BUDGETS = """# Page

Words.

## E3: Figure 8b: error over budget

*Asked:* what?

table, mse:

| at samples per pixel | 2 | 4 |
|---|---|---|
| *uniform + box, MSE* | 1.69 [1.60, 1.80] | 0.76 |
| multiscale{a=1\\|2} | 0.50 | 0.25 [0.24, 0.26] |

chess, mse:

| at samples per pixel | 2 | 4 |
|---|---|---|
| multiscale{a=1\\|2} | 0.9 [0.8, 1.0] | – |

- multiscale is below: agrees.
"""


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_tables_of_one_header_share_a_file_and_ends_have_columns_of_their_own(tmp_path):
    text = take_apart(BUDGETS, "experiments", tmp_path / "results")
    rows = rows_of(tmp_path / "results/experiments/e3.csv")
    assert [row["of"] for row in rows] == ["table, mse", "table, mse", "chess, mse"]
    assert rows[0] == {"of": "table, mse", "at samples per pixel": "uniform + box, MSE", "2": "1.69", "2 low": "1.60",
                       "2 high": "1.80", "4": "0.76", "4 low": "", "4 high": ""}
    assert rows[1]["at samples per pixel"] == "multiscale{a=1|2}" and rows[1]["4 high"] == "0.26"
    assert rows[2]["2 low"] == "0.8" and rows[2]["4"] == "–"
    assert "| 2 |" not in text and "table, mse" not in text
    assert "[e3.csv](results/experiments/e3.csv)" in text
    assert text.index("*Asked:*") < text.index("e3.csv") < text.index("- multiscale is below: agrees.")


def test_short_tables_stay_and_long_ones_go(tmp_path):
    def page(rows):
        return "## A\n\n" + "\n".join(["| name | value |", "|---|---|", *[f"| r{i} | {i} |" for i in range(rows)]]) + "\n"
    assert take_apart(page(SHORT), "page", tmp_path) == page(SHORT)
    assert "| r0 |" not in take_apart(page(SHORT + 1), "page", tmp_path)
    assert len(rows_of(tmp_path / "page/a.csv")) == SHORT + 1


def test_files_of_chapters_that_are_gone_are_removed(tmp_path):
    take_apart(BUDGETS, "page", tmp_path)
    take_apart(BUDGETS.replace("E3:", "E4:"), "page", tmp_path)
    assert [path.name for path in (tmp_path / "page").iterdir()] == ["e4.csv"]


def test_what_a_page_shows_is_there_while_it_is_written_again(tmp_path):
    seen = []

    def plot(path, tables):
        seen.append(sorted(p.name for p in (tmp_path / "page").glob("[!.]*")))
        path.write_text("drawn")
        return "a drawing"
    for _ in range(2):
        take_apart(BUDGETS, "page", tmp_path, plot)
    assert seen == [["e3.csv"], ["e3.csv", "e3.svg"]]
    assert sorted(p.name for p in (tmp_path / "page").iterdir()) == ["e3.csv", "e3.svg"]


def test_a_plot_draws_ratios_over_budgets_and_says_so(tmp_path):
    pytest.importorskip("matplotlib")
    from budget_plot import plot, series_of
    from page_tables import parse
    text = take_apart(BUDGETS, "page", tmp_path, plot)
    assert "![e3: error over budget](" in text
    assert "relative to uniform + box" in (tmp_path / "page/e3.svg").read_text(encoding="utf-8")
    lines, base = series_of(parse(BUDGETS.split("\n\n")[5], "table, mse"))
    assert base == "uniform + box" and lines == {"multiscale{a=1|2}": [(2.0, 0.5, 0.5, 0.5), (4.0, 0.25, 0.24, 0.26)]}


def test_the_same_table_gives_the_same_bytes(tmp_path):
    pytest.importorskip("matplotlib")
    from budget_plot import plot
    for folder in ("a", "b"):
        take_apart(BUDGETS, "page", tmp_path / folder, plot)
    assert (tmp_path / "a/page/e3.svg").read_bytes() == (tmp_path / "b/page/e3.svg").read_bytes()


def test_a_page_is_the_old_one_or_the_new_one(tmp_path):
    page = tmp_path / "page.txt"
    page.write_text("old")
    with pytest.raises(TypeError):
        write_whole(page, None)
    assert page.read_text() == "old" and list(tmp_path.iterdir()) == [page]
    write_whole(page, "one")
    write_whole(page, "two")
    assert page.read_text() == "two" and list(tmp_path.iterdir()) == [page] and page.stat().st_mode & 0o777 == 0o644
