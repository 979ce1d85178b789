"""What a recorder's dry run says of a plan: the layers that none of its methods reads."""
import os

import pytest

from conftest import ROOT, check_ok, record
from dumps.recording.failure import Failure
from dumps.recording.plan_layers import methods_of, read_by, unread

ALL = ["radiance", "albedo", "normal", "depth", "film", "lens"]
PLANS = os.path.join(ROOT, "tools", "plans")


@pytest.fixture
def plan(tmp_path):
    def written(text):
        path = tmp_path / "plan.toml"
        path.write_text(text)
        return str(path)
    return written


def test_layers_follow_from_the_methods(plan):
    assert read_by(plan('samplers = ["uniform"]\nfilters = ["box", "directional"]')) == {"radiance"}
    assert read_by(plan('samplers = ["uniform"]\nfilters = ["mine=cross_bilateral:robust{a=1}"]')) == {"radiance", "albedo", "normal", "depth"}
    assert read_by(plan('samplers = ["uniform"]\n[[filter]]\nname = "greedy_selection"')) >= {"radiance", "film"}
    assert "film" in read_by(plan('samplers = ["uniform"]\n[[filter]]\nname = "directional"\nrecon_granularity = ["piece", "sample"]'))
    assert "film" in read_by(plan('samplers = ["uniform"]\nfilters = ["box"]\npieces_per_side = 2'))
    assert list(methods_of({"filters": ["a=b:c{d=e}", "f{g=h}", "i"]}, "filter")) == ["b", "f", "i"]


def test_what_is_left_out_is_a_line_with_the_option_that_does_it(plan):
    path = plan('samplers = ["uniform"]\nfilters = ["box"]')
    assert unread(path, ALL) == f"no method of {path} reads albedo, normal, depth, film, lens: --channels radiance leaves them out"
    assert unread(path, ["radiance"]) == ""
    assert unread(os.path.join(PLANS, "features.toml"), ALL[:4]) == ""


def test_a_file_that_is_no_plan_is_refused(plan):
    for path, code in ((plan("samplers = ["), 2), ("nowhere.toml", 3)):
        with pytest.raises(Failure) as refused:
            read_by(path)
        assert refused.value.code == code


def test_the_dry_run_says_it(plan):
    path = plan('samplers = ["uniform"]\nfilters = ["box"]')
    said = check_ok(record("cornell-box", "--dry-run", "--size", 8, "--samples", 4, "--plan", path)).stdout
    assert "reads albedo, normal, depth, film: --channels radiance" in said
