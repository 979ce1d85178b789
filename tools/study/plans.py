"""The plans of tools/plans, as they are and on recordings of full size, and the recordings that they name.

A plan keeps its methods, budgets and claims at full size, and gets what tools/plans/full_size/PLAN.toml says in addition; what stands there
under `instead` replaces it, and claims about samplers that are then not there go.
"""
import json
import os
import subprocess
from pathlib import Path

import tomllib

from tools.study.kept import Failed

ROOT = Path(__file__).resolve().parents[2]
PLANS = ROOT / "tools/plans"
NAMED = tomllib.loads((Path(__file__).parent / "recordings.toml").read_text(encoding="utf-8"))
FULL = NAMED["full"]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "spool"
RECORDINGS = Path(os.environ.get("SPOOL_RECORDINGS") or CACHE / "recordings")


def read(path):
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as reason:
        raise Failed(f"{path}: {getattr(reason, 'strerror', None) or reason}") from reason


def merged(plan, more):
    """Lists are joined, other keys replaced."""
    joined = {k: v + more[k] if isinstance(v, list) and k in more else more.get(k, v) for k, v in plan.items()}
    return {**more, **joined}


def group_of(name):
    """The scene of a recording NAME_1, NAME_2 ...; none of any other."""
    scene, _, number = name.rpartition("_")
    return scene if number.isdigit() and 1 <= int(number) <= FULL["groups"].get(scene, 0) else None


def full_plan(name, files):
    """The plan on these recordings of full size."""
    more = PLANS / "full_size" / f"{name}.toml"
    more = read(more) if more.exists() else {}
    instead = more.pop("instead", {})
    plan = {**merged(read(PLANS / f"{name}.toml"), more), **instead}
    if "samplers" in instead:
        plan["claim"] = [c for c in plan["claim"] if {c[side].partition(" + ")[0] for side in ("better", "than")} <= set(instead["samplers"])]
    groups = [group_of(Path(f).stem) for f in files]
    if any(groups):
        dumps = [{"file": str(f), "group": g} for f, g in zip(files, groups)]
        return {**{k: v for k, v in plan.items() if k != "recordings"}, "dump": dumps}
    return {**plan, "recordings": [str(f) for f in files], "replicates": more.get("replicates", FULL["replicates"]), "pictures": False}


def full_recordings(name):
    """Names of the recordings of full size that the plan asks for, whether they are here or not."""
    if name in FULL["only"]:
        return FULL["only"][name]
    if name not in FULL["alone"]:
        return [*FULL["recordings"], *FULL["more"].get(name, [])]
    own = [Path(path).stem for path in read(PLANS / f"{name}.toml")["recordings"]]
    own = [f"{r}_{i}" for r in own for i in range(1, FULL["groups"][r] + 1)] if own[0] in FULL["groups"] else own
    return [FULL["instead"].get(r, r) for r in own]


def _value(value):
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {_value(v)}" for k, v in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)


def text_of(plan):
    """As TOML."""
    return "".join(f"{key} = {_value(value)}\n" for key, value in plan.items())


def make_recording(program, folder, name, made_by):
    """An analytic recording; a finished file appears under its name at once, so a name means done."""
    path = folder / f"{name}.spool"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene, side, samples, seed = made_by
        subprocess.run([program, "synth", scene, "--size", str(side), "--samples", str(samples), "--seed", str(seed), "-o", path, "-q"],
                       check=True)
    return path


def make_recordings(program, folder=PLANS / "pools"):
    """Those that the plans name at 64 x 64 pixels."""
    for name, made_by in NAMED["analytic"].items():
        make_recording(program, folder, name, made_by)


def full_recording(program, name, folder):
    """Its file, or None where it is not here; analytic ones are made in the folder."""
    if name in FULL["analytic"]:
        return make_recording(program, folder, name, FULL["analytic"][name])
    path = RECORDINGS / f"{name}.spool"
    return path if path.exists() else None
