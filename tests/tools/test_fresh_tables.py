"""Bias, variance and fresh samples on the pages of experiments."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools/experiments"))
from fresh_tables import COLUMNS, biases, fresh  # noqa: E402
from page_tables import cells  # noqa: E402
from results import Results  # noqa: E402

PROGRAM = os.environ.get("SPOOL_PROGRAM", "spool")
UNIFORM, SMOOTH, NONE = ("uniform", "box"), ("uniform", "gaussian"), ("uniform", "median")


def evaluated(folder, more):
    subprocess.run([PROGRAM, "synth", "scene_s", "--size", "32", "--samples", "128", "-o", folder / "scene_s.spool", "-q"], check=True)
    plan = folder / "plan.toml"
    plan.write_text(f'recordings = ["scene_s.spool"]\nspp = [32]\nreplicates = 2\npictures = false\n{more}\n'
                    'samplers = ["uniform"]\nfilters = ["box", "gaussian"]\n')
    subprocess.run([PROGRAM, "evaluate", plan, "-o", folder / "results", "-q"], check=True)
    return Results([folder / "results"])


@pytest.fixture(scope="module")
def with_fresh(tmp_path_factory):
    return evaluated(tmp_path_factory.mktemp("fresh"), "fresh = true")


def rows_of(block):
    return [cells(line) for line in block.split("\n\n")[1].split("\n")[2:]]


def test_a_wide_filter_is_biased_and_uniform_sampling_is_not(with_fresh):
    sizes, shares = biases(with_fresh, 32, [UNIFORM, SMOOTH])
    (_, none), (_, smooth) = rows_of(shares)
    assert abs(float(none.removesuffix(" %"))) < 10 and float(smooth.removesuffix(" %")) > 50, (none, smooth)
    mean = sum(with_fresh.values("mse_bias2", "scene_s", *SMOOTH, 32)) / 2
    assert float(rows_of(sizes)[1][1].split(" ")[0]) == pytest.approx(mean, rel=5e-3)


def test_the_table_has_the_columns_of_the_methods_that_ran(with_fresh):
    (row,) = rows_of(fresh(with_fresh, 32, [SMOOTH, NONE], "every filter"))
    assert row[:2] == ["scene S", "uniform + gaussian"]
    shown = dict(zip(COLUMNS, (float(text.split(" ")[0]) for text in row[2:])))
    mean = sum(with_fresh.values("mse_bias2", "scene_s", *SMOOTH, 32)) / 2
    assert shown["bias²"] == pytest.approx(mean, rel=5e-3)
    assert shown["bias²"] + shown["variance"] == pytest.approx(shown["MSE, fresh"], rel=0.2)


def test_of_a_plan_without_fresh_there_is_no_table(tmp_path):
    without = evaluated(tmp_path, "")
    assert without.values("mse_fresh", "scene_s", *UNIFORM, 32) == []
    assert fresh(without, 32, [UNIFORM]) == "" and biases(without, 32, [UNIFORM]) == []
