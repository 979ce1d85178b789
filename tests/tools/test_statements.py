"""Statements of the generated pages of experiments: how they are read, compared between pages, and decided together."""
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
import full_page  # noqa: E402
import paper_table  # noqa: E402
from inference import Interval  # noqa: E402
from rare_samples import LIMIT, shares  # noqa: E402
from results import Results  # noqa: E402
from statements import as_table, change_rows, kinds_of_change, of_the_paper, statements  # noqa: E402

SMALL = """## E1: Levels

- 5-3 puts more there than Haar: table, robust: yes; table, paper: **no**; scene S, robust: not told apart.

## E2: Budgets

- paper: 5-3 is below haar in MSE: **disagrees**, in part not told apart. Table: not told apart at 16; above at 4, 8 spp. scene S: above at 4 spp.
- 5-3 is below db3: agrees. Table: below at 4 spp.
- multiscale is below mitchell: undecided: not told apart. Table: not told apart at 4 spp.
- never run: not measured. Not measured.
"""
FULL = """## E1: Levels

- 5-3 puts more there than Haar: table, robust: yes; scene S, robust: yes.

## E2: Budgets

- paper: 5-3 is below haar in MSE: agrees. Table: below at 4, 8, 16 spp. torus: below at 4 spp. scene S: above at 4 spp.
- 5-3 is below db3: **mixed**. Table: below at 4 spp. torus: above at 4 spp.
- multiscale is below mitchell: undecided: not told apart. Table: not told apart at 4 spp.
"""


def test_a_statement_is_known_recording_by_recording():
    found = statements("## E5: density\n- no blocks (index below 1.2): agrees. chess: 1.02. scene S, 512 x 512: 0.96.\n"
                       "- a is below b: agrees. Scene S: below at 4, 8 spp. mist: below at 16; not told apart at 4, 8 spp.\n")
    assert found["E5", "no blocks (index below 1.2)"].pools == {"chess": "1.02", "scene S, 512 x 512": "0.96"}
    assert found["E5", "a is below b"].pools == {"scene S": "below at 4, 8", "mist": "below at 16; not told apart at 4, 8"}


def test_statements_that_changed_are_found():
    before, after = statements(SMALL), statements(FULL)
    assert before["E1", "5-3 puts more there than Haar"].verdict == "**mixed**"
    assert after["E1", "5-3 puts more there than Haar"].verdict == "agrees"
    assert before["E2", "multiscale is below mitchell"].verdict == "undecided: not told apart"
    rows = change_rows(before, after)
    assert [row[0] for row in rows] == ["E1: 5-3 puts more there than Haar", "E2: paper: 5-3 is below haar in MSE", "E2: 5-3 is below db3"]
    assert rows[1][1:] == ["**disagrees**, in part not told apart", "agrees",
                           "table: not told apart at 16; above at 4, 8 → below at 4, 8, 16"]
    assert rows[0][3] == "scene S, robust: not told apart → yes" and rows[2][3] == "–"
    assert kinds_of_change(rows) == (1, 0, 2)
    assert kinds_of_change([["", "agrees", "undecided: not told apart", ""], ["", "**mixed**", "**disagrees**", ""]]) == (0, 1, 1)
    assert [(then.agrees, now.agrees, fresh) for then, now, fresh in of_the_paper(before, after)] == [
        (False, True, None), (False, False, None), (True, False, None), (False, False, None)]
    said = "\n".join(paper_table.of_paper(SMALL, FULL))
    assert ("(E1: about both): of 3 statements 1 agrees, 1 is mixed and 1 is undecided. Of 3 that were asked on pictures of 64 x 64 pixels as well, 0 turned round. "
            "Agree now, and did not there: E1: 5-3 puts more there than Haar (mixed there). Agreed there, and do not now: E2: 5-3 is below db3 (agrees there).") in said
    assert "as printed: of 1 statements 1 is mixed." in said
    assert "| E2: 5-3 is below db3 | agrees | **mixed** | – | – | – | – |" in said


def test_a_statement_of_several_chapters_is_one():
    found = statements("## E9: chess\n- a is below b in relMSE: agrees. Torus: below at 8 spp (energy 0.52 / 0.99).\n"
                       "## E10: balls\n- a is below b in relMSE: undecided: not told apart. Torus: below at 8 spp. mist: not told apart at 8 spp.\n"
                       "- a is below b in relMSE on fresh samples: **disagrees**. Mist: above at 8 spp.\n"
                       "## E11: over budget\n- a is below b in relMSE at 4 samples per pixel and more: **mixed**. Balls: below at 4; above at 8 spp.\n")
    (then, now, fresh), = of_the_paper({}, found)
    assert then is None and now.chapter == "E9, E10, E11" and now.verdict == "**mixed**" and fresh.verdict == "**disagrees**"
    assert now.pools == {"torus": "below at 8", "mist": "not told apart at 8", "balls": "below at 4; above at 8"}
    assert now.on(["torus", "mist", "balls"]) == (1, 1, 1) and paper_table.losing(now) == 1
    assert paper_table.counts(["agrees, in part not told apart", "**disagrees**", "**disagrees**", "undecided: not told apart"]) == (
        "1 agrees, 2 disagree and 1 is undecided")


def test_light_that_is_lost_and_fresh_samples_stand_beside_a_statement():
    full = ("## E3: samplers\n- |d| is below b: agrees. Table: below at 4, 8 spp (energy 0.91 / 0.99). mist: below at 4, 8 spp.\n"
            "- |d| is below b on fresh samples: **disagrees**. Table: above at 4, 8 spp.\n")
    found = statements(full)["E3", "|d| is below b"]
    assert found.energies == {"table": "0.91 / 0.99"} and found.pools == {"table": "below at 4, 8", "mist": "below at 4, 8"}
    rows = paper_table.of_paper("", full, {"table_256": 0.4, "mist_256": 0.1})[-1].splitlines()[2:]
    assert rows == ["| E3: \\|d\\| is below b | – | agrees | **disagrees** | 1 of 1 | 1 of 1 | 1 |"]


def test_a_list_of_statements_is_a_table_of_recordings():
    listed = ("- |d| is below b: **mixed**. Table: below at 4, 8 spp (energy 0.91 / 0.99). mist: below at 4; not told apart at 8 spp.\n"
              "- c is below b: **disagrees**. Mist: above at 4, 8 spp.\n- shown: 1.02.\n- more there: torus, robust: **no**.")
    shown, rest = full_page.with_table(listed)
    assert shown.splitlines()[2:] == ["| \\|d\\| is below b | **mixed** | below (0.91 / 0.99) | below 4; = 8 | – |",
                                      "| c is below b | **disagrees** | – | above | – |", "| more there | **disagrees** | – | – | **no** |"]
    assert shown.startswith("| statement | verdict | table | mist | torus, robust |") and rest == "- shown: 1.02."
    assert full_page.with_table("- shown: 1.02.\n- and more.") == ["- shown: 1.02.\n- and more."]
    assert as_table([])[1] == []


def test_recordings_on_which_a_statement_came_out_are_counted():
    found = statements("## E1: levels\n- more there: scene S, robust: yes; scene S, paper: **no**; table, robust: not told apart.\n"
                       "## E7: tiles\n- a is below b: **mixed**. Scene S, 512 x 512: below at 4 spp. mist: below at 4; above at 8 spp. table: 1.02.\n")
    assert found["E1", "more there"].on(["scene S"]) == (1, 0, 1) and found["E1", "more there"].on(["table"]) == (0, 1, 0)
    tiles = found["E7", "a is below b"]
    assert tiles.on(["scene S"]) == (0, 0, 0) and tiles.on(["scene S, 512 x 512", "mist", "table"]) == (1, 0, 1)


def test_rare_bright_samples_are_told_by_the_share_of_the_worst_pixels():
    kept = sorted((ROOT / "docs/results/experiments_full/measured/e3_samplers_over_budget").glob("*.jsonl"))
    found = shares(kept)
    assert found["mist_256"] < LIMIT / 2 and found["torus"] > LIMIT and set(found) == {path.stem for path in kept}


def asked_of(ratios):
    """Results of four replicates in which only these pairs of samplers are known: {(first, second): ratio with its interval}."""
    results = Results([])
    for name in {name for pair in ratios for name in pair}:
        results._rows["table", name, "box", 4, 1] = [{"replicate": r, "mse": None} for r in range(4)]
    results._pairs["table", 4, 1, "mse"] = {((a, "box"), (b, "box")): ("undecided", Interval(*ratio)) for (a, b), ratio in ratios.items()}
    return results


def order_of_first(results):
    return [results.order("mse", "table", 4, (a, "box"), (b, "box")) for a, b in (("a", "b"), ("b", "a"))]


def test_what_a_chapter_asks_is_one_family():
    more = {("a", f"x{i}"): (1.0, 0.8, 1.25) for i in range(30)}
    results = asked_of({("a", "b"): (0.5, 0.4, 0.62), **more})  # p = 0.002 by Student's test with three degrees of freedom
    assert order_of_first(results) == [0, 0], "among all pairs of the plan"
    results.judge_asked()
    assert order_of_first(results) == [-1, 1], "alone"
    for name in (name for _, name in more):
        assert results.order("mse", "table", 4, ("a", "box"), (name, "box")) == 0
    results.judge_asked()
    assert order_of_first(results) == [0, 0], "one of 31"


def test_a_pair_without_a_ratio_keeps_its_verdict():
    results = asked_of({("a", "b"): ()})
    results._pairs["table", 4, 1, "mse"] = {(("a", "box"), ("b", "box")): ("better", Interval())}
    assert order_of_first(results) == [-1, 1]
    results.judge_asked()
    assert order_of_first(results) == [-1, 1]


def test_the_pages_of_the_tree_have_statements():
    found = statements((ROOT / "docs/experiments.md").read_text(encoding="utf-8"))
    assert {chapter for chapter, _ in found} >= {"E1", "E2", "E3", "E4", "A1", "A7"}
