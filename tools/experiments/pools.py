"""Makes the analytic pools that plans in tools/plans name; they cost seconds, so they are not in the tree."""
import subprocess
from pathlib import Path

PLANS = Path(__file__).resolve().parents[1] / "plans"

# name: (scene, pixels per side, samples per pixel, seed)
POOLS = {
    "scene_s": ("scene_s", 64, 64, 5),
    "scene_s_fireflies": ("scene_s_fireflies", 64, 64, 5),
    "scene_s_128": ("scene_s", 128, 64, 6),
    "scene_s_fireflies_128": ("scene_s_fireflies", 128, 64, 6),
    "scene_s_n32": ("scene_s", 64, 32, 5),
    "scene_s_n64": ("scene_s", 64, 64, 5),
    "scene_s_n128": ("scene_s", 64, 128, 5),
    "scene_s_n256": ("scene_s", 64, 256, 5),
}

# One difficulty each: no experiment of docs/experiments.md uses them, tuning is judged on them.
STRESS_POOLS = {f"stress_{scene}": (scene, 64, 64, 11) for scene in (
    "slanted_edge", "soft_shadow", "streaks", "fine_checker", "fireflies")}


def command(name, folder="tools/plans/pools"):
    scene, side, samples, seed = (POOLS | STRESS_POOLS)[name]
    return f"spool synth {scene} --size {side} --samples {samples} --seed {seed} -o {folder}/{name}.spool"


def make_pools(program, folder):
    """Those that are missing. A finished file appears under its name at once, so a name means done."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in POOLS | STRESS_POOLS:
        if not (folder / f"{name}.spool").exists():
            subprocess.run([program, *command(name, folder).split()[1:], "-q"], check=True)
