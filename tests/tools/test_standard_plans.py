"""The plans of tools/plans: each is understood, and together they miss no method and no experiment."""
import json
import subprocess
import tomllib
from pathlib import Path

import pytest

from conftest import LONGEST_RUN, PROGRAM, WITH_OIDN
from tools.study.plans import make_recording, make_recordings

ROOT = Path(__file__).resolve().parents[2]
MADE_ELSEWHERE = {"counts", "ensemble", "exec", "image", "oidn", "python"}  # need a file, a command, a library or other filters
PLANS = sorted((ROOT / "tools/plans").glob("*.toml"))


@pytest.fixture(scope="module")
def plans(tmp_path_factory):
    """The plans beside the recordings that they name, in a folder of their own."""
    tree = tmp_path_factory.mktemp("tree")
    (tree / "tools/plans").mkdir(parents=True)
    (tree / "dumps").symlink_to(ROOT / "dumps")
    for plan in PLANS:
        (tree / "tools/plans" / plan.name).write_text(plan.read_text())
    make_recordings(PROGRAM, tree / "tools/plans/pools")
    asked = {name for plan in PLANS for name in tomllib.loads(plan.read_text()).get("recordings", ()) if "/" not in name}
    for seed, name in enumerate(sorted(asked)):  # recordings of full size, which are made elsewhere: a small one stands for each
        made = make_recording(PROGRAM, tree, name, ("scene_s", 16, 1024 if name.endswith("_long") else 256, seed))
        (tree / "tools/plans" / name).symlink_to(made)
    return tree / "tools/plans"


def cells_of(plan):
    finished = subprocess.run([PROGRAM, "evaluate", plan, "--dry-run", "--json"], text=True,
                              capture_output=True, timeout=LONGEST_RUN, env=WITH_OIDN)
    assert finished.returncode == 0, finished.stderr
    return json.loads(finished.stdout)


@pytest.mark.parametrize("name", [p.name for p in PLANS])
def test_a_plan_names_methods_options_and_recordings_that_exist(plans, name):
    assert cells_of(plans / name)["cells"] > 0


def test_each_experiment_and_ablation_has_a_plan():
    ids = {p.stem.split("_")[0] for p in PLANS}
    assert ids >= {f"e{i}" for i in range(1, 11)} | {f"a{i}" for i in range(1, 13)}
    assert ids >= {"standard", "methods", "prototypes"}


@pytest.mark.parametrize("kind, flag", [("samplers", "sampler"), ("filters", "filter")])
def test_the_plans_of_all_methods_name_every_method(plans, kind, flag):
    listed = json.loads(subprocess.run([PROGRAM, "list", kind, "--json"], text=True,
                                       capture_output=True, check=True).stdout)
    names = {m["name"] for m in listed} - MADE_ELSEWHERE
    text = "".join((plans / name).read_text() for name in ("methods.toml", "features.toml", "filters.toml"))
    assert {n for n in names if f'"{n}"' not in text} == set(), f"tools/plans/methods.toml: add this {flag}"


def test_the_recordings_of_the_plan_of_features_have_them(plans):
    for name in tomllib.loads((plans / "features.toml").read_text())["recordings"]:
        info = json.loads(subprocess.run([PROGRAM, "info", plans / name, "--json"], text=True,
                                         capture_output=True, check=True).stdout)
        channels = {layer["name"] for layer in info["layers"]}
        assert channels >= {"normal", "albedo", "depth"}, name


def test_a_misspelt_option_in_a_plan_is_found(plans):
    broken = plans / "broken.toml"
    broken.write_text((plans / "a3_alpha.toml").read_text().replace("alpha = [", "alhpa = ["))
    finished = subprocess.run([PROGRAM, "evaluate", broken, "--dry-run"], text=True, capture_output=True,
                              timeout=LONGEST_RUN)
    broken.unlink()
    assert finished.returncode == 2 and "did you mean 'alpha'" in finished.stderr
