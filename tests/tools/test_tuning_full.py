"""The part of docs/tuning.md about full size: who is left out, when the defaults should change, and that it replaces itself."""
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
import tuning_full  # noqa: E402
from full_size import recordings_of  # noqa: E402
from inference import use_program  # noqa: E402
from results import Results  # noqa: E402
from whole_file import with_last_part  # noqa: E402

use_program(os.environ.get("SPOOL_PROGRAM", "spool"))
WOBBLE = [0.98, 1.0, 1.01, 0.99]
LARGE = "directional{levels=3}"


def results_with(errors, energy=1.0):
    """errors: {recording: relMSE of levels=3, where the defaults have 1}"""
    made = Results([])
    for pool, error in errors.items():
        for f, value, light in (("directional", 1.0, 1.0), (LARGE, error, energy)):
            for b in tuning_full.BUDGETS:
                made._rows[pool, "multiscale", f, b, 0] = [
                    {"replicate": r, "relmse": value * w, "energy_ratio": light} for r, w in enumerate(WOBBLE)]
                made._figures[pool, "multiscale", f, b, 0] = {}
    return made


@pytest.fixture
def section(monkeypatch):
    def made(errors, energy=1.0):
        results = results_with(errors, energy)
        monkeypatch.setattr(tuning_full, "Results", lambda sources: results)
        return tuning_full.section([], ["mist_256"])
    return made


CHOOSE = dict.fromkeys(("chess_256", "torus", "balls_256"), 0.8)


def test_the_defaults_change_only_where_it_helps_on_those_left_out_and_on_those_kept_apart(section):
    assert "the defaults should change" in section(CHOOSE | {"scene_s": 0.9})
    text = section(CHOOSE | {"scene_s": 1.1})
    assert "the defaults stay" in text and "changes relMSE by -20.0 %" in text and "changes it by +10.0 %" in text
    assert "nothing changes" in section(dict.fromkeys(CHOOSE, 1.2))
    assert "nothing changes" in section(CHOOSE | {"scene_s": 0.9}, energy=0.7), "1 % of energy costs 2 % of relMSE"


def test_a_gain_on_a_few_scenes_is_not_one_on_others(section):
    text = section({"chess_256": 0.5, "torus": 0.99, "balls_256": 0.6, "mist_256": 0.995, "scene_s": 0.9})
    assert "not on enough scenes to say so of others: the defaults stay" in text


def test_single_options_are_shown_with_what_they_do_on_both_sets(section):
    text = section(CHOOSE | {"scene_s": 0.9, "balls_256": 1.1})
    row = next(line for line in text.splitlines() if line.startswith("| filter: `levels=3` | -"))
    assert "-11.0 % (-11.0 % .. -11.0 %) | -10.0 % (-10.0 % .. -10.0 %)" in row and "+10.0 % (balls, " in row and "| 1.00 |" in row
    assert "beyond the noise of the samples: filter: `levels=3` (-11.0 % and -10.0 %" in text
    assert "By themselves" not in section(CHOOSE | {"scene_s": 1.1})


def test_a_recording_left_out_has_no_say(section):
    text = section(CHOOSE | {"balls_256": 400.0})
    rows = {line.split("|")[1].strip(): line.split("|")[2].strip() for line in text.splitlines() if line.startswith("| ")}
    assert rows["balls"] == "filter: `levels=3`" and rows["chess"] == rows["torus"] == "the defaults"


def test_fewer_than_three_choose_nothing_and_what_is_missing_is_named(section):
    text = section({"chess_256": 0.8, "torus": 0.8, "scene_s": 0.9})
    assert "needs three recordings" in text and "Not measured yet: mist." in text


def test_the_part_replaces_itself_and_leaves_the_page():
    once = with_last_part("# Tuning\n\nWords.\n", tuning_full.TITLE, tuning_full.TITLE + "\n\nOld.\n")
    assert with_last_part(once, tuning_full.TITLE, tuning_full.TITLE + "\n\nNew.\n") == "# Tuning\n\nWords.\n\n## At full size\n\nNew.\n"


def test_a_preset_is_a_change_of_the_defaults():
    assert tuning_full.options_of("multiscale:paper{alpha=0.3}") == (("preset", "paper"), ("alpha", "0.3"))
    assert tuning_full.options_of("directional:paper") == (("preset", "paper"),) and tuning_full.options_of("directional") == ()


def test_every_recording_of_the_plan_has_its_role():
    wanted = recordings_of(ROOT / "tools/plans" / f"{tuning_full.PLAN}.toml")
    assert sorted(wanted) == sorted((*tuning_full.CHOOSING, *tuning_full.APART))
