"""The plans of tools/plans on recordings of full size (dumps/POOLS.toml): `tools/dev.sh experiments --full`.

A plan keeps its methods and budgets. Its recordings of 64 x 64 pixels are replaced by those of 256 x 256 with 256 samples,
and pictures by others are added where the question is how methods compare. Recordings that are not there yet are left out.
"""
import os
import re
import subprocess
import tomllib
from pathlib import Path

RECORDINGS = Path(os.environ.get("SPOOL_RECORDINGS", os.path.join(
    os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "spool", "recordings")))
RECORDED = ("chess", "balls", "table", "caustic", "fireflies", "mist")  # of Cycles, under the same names in dumps/tiny
OTHERS = ("cornell_box_picture", "torus", "matpreview", "thin_lens")
WITH_OTHERS = ("e3_samplers_over_budget", "e4_directions", "e9_chess", "a6_size_rule", "features")
REPLICATES = 4  # 256 x 256 pixels hold sixteen pictures of 64 x 64

# As tools/experiments/pools.py: (scene, pixels per side, samples per pixel, seed).
ANALYTIC = {
    "scene_s": ("scene_s", 256, 256, 5),
    "scene_s_fireflies": ("scene_s_fireflies", 256, 256, 5),
    "scene_s_128": ("scene_s", 512, 64, 6),
    "scene_s_fireflies_128": ("scene_s_fireflies", 512, 64, 6),
}
# What asks for something else than large pictures, or names its recordings.
LEFT_OUT = ("first", "prototypes", "A10", "A11", "E6")


def full_name(name):
    return f"{name}_256" if name in RECORDED else name


def analytic_pools(program, folder):
    """Makes those that are missing."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (scene, side, samples, seed) in ANALYTIC.items():
        if not (folder / f"{name}.spool").exists():
            subprocess.run([program, "synth", scene, "--size", str(side), "--samples", str(samples), "--seed", str(seed),
                            "-o", folder / f"{name}.spool", "-q"], check=True)


def recordings_of(plan, name, analytic):
    """Files of full size for the recordings that the plan names, those that are there."""
    stems = [Path(path).stem for path in plan["recordings"]]
    files = [analytic / f"{stem}.spool" if stem in ANALYTIC else RECORDINGS / f"{full_name(stem)}.spool" for stem in stems]
    if name in WITH_OTHERS:
        files += [RECORDINGS / f"{other}.spool" for other in OTHERS]
    return [file for file in files if file.exists()]


def write_plan(source, target, analytic):
    """False where none of the recordings is there."""
    text = source.read_text()
    files = recordings_of(tomllib.loads(text), source.stem, analytic)
    if not files:
        return False
    listed = ", ".join(f'"{file}"' for file in files)
    text = re.sub(r"^recordings = \[.*?\]$", lambda _: f"recordings = [{listed}]", text, count=1, flags=re.M | re.S)
    text = re.sub(r"^replicates = \d+$", f"replicates = {REPLICATES}", text, count=1, flags=re.M)
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text)
    return True


def write_plans(program, chapters, source, folder):
    """The plans of the chapters in `folder`, and the chapters whose plans all have recordings."""
    analytic = folder.parent / "pools"
    analytic_pools(program, analytic)
    written = {}
    for plan in dict.fromkeys(p for c in chapters if c.id not in LEFT_OUT for p in c.plans):
        written[plan] = write_plan(source / f"{plan}.toml", folder / f"{plan}.toml", analytic)
    return [c for c in chapters if c.id not in LEFT_OUT and all(written[p] for p in c.plans)]
