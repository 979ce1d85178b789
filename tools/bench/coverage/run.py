"""Measures how often 95 % intervals hold another recording: tools/dev.sh bench coverage [SCENE...] (default: all).

Every scene is redrawn several times; each redrawn recording is evaluated by the program as a user does it, and its intervals
are held against the mean of the others. What is done is not done again (build/coverage_results). docs/results/coverage
keeps the scenes that were not asked for; docs/coverage.md is written from it.
"""
import argparse
import datetime
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import spool
from tools.bench.coverage import page
from tools.study import kept
from tools.study.plans import RECORDINGS, ROOT

BUDGETS = "4,8,16"
QUANTITIES = ("mse", "relmse", "energy_ratio")


class Scene(NamedTuple):
    source: Path | None  # None: scene S, made anew for each recording
    side: int = 64
    samples: int = 64
    count: int = 10  # recordings
    samplers: str = "uniform,mitchell,adaptive_wavelet,greedy_error,nl_means,multiscale"


SMALL = {"scene_s": None, **{name: ROOT / f"dumps/tiny/{name}.spool" for name in (
    "balls", "caustic", "caustic_mitsuba", "chess", "fireflies", "mist", "table")}}  # chess_sequence redrawn is no sequence
LARGE = {name: RECORDINGS / f"{name}.spool" for name in ("caustic_mitsuba_256", "cornell_box_picture")}
FULL = {"side": 256, "samples": 256, "samplers": "uniform,multiscale"}
PAPER = {"samplers": "uniform,multiscale:paper"}
LOOP = {"samplers": "uniform,denoised_variance,filtered_halves,cross_halves"}
OTHERS = {"samples": 256, "samplers": "uniform,mitchell,adaptive_wavelet,greedy_error,nl_means,denoised_variance,filtered_halves,cross_halves"}
SCENES = {
    **{name: Scene(source) for name, source in SMALL.items()},
    **{f"{name}, two samplers": Scene(source, count=60, samplers="uniform,multiscale") for name, source in SMALL.items()},
    **{f"{name}, filter in the loop": Scene(source, **LOOP) for name, source in SMALL.items()},
    "scene_s, paper": Scene(None, **PAPER), "caustic_mitsuba, paper": Scene(ROOT / "dumps/tiny/caustic_mitsuba.spool", **PAPER),
    "scene_s_256": Scene(None, **FULL), **{name: Scene(source, **FULL) for name, source in LARGE.items()},
    "scene_s, other samplers": Scene(None, **OTHERS),
    **{f"{name}, other samplers": Scene(source, side=256, count=4, **OTHERS) for name, source in LARGE.items()}}


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=False, capture_output=True, text=True)


def redrawn(scene, number, path):
    """Every sample drawn with replacement; the mean of the recording is the exact reference."""
    if scene.source is None:
        run("synth", "scene_s", "--size", scene.side, "--samples", scene.samples, "--seed", 1000 + number, "-o", path, "-q")
        return
    radiance = spool.open(scene.source).read("radiance")
    chosen = np.random.default_rng(1000 + number).integers(0, radiance.shape[2], (*radiance.shape[:2], scene.samples))
    spool.write(path, np.take_along_axis(radiance, chosen[..., None], axis=2).astype(np.float32), sample_order="exchangeable",
                reference=radiance.mean(2, dtype=np.float64).astype(np.float32), force=True)


def evaluated(scene, number, folder):
    """The folder of its results; and the same with halves left out."""
    results, old = folder / f"results{number}", folder / f"old{number}"
    if not (results / "statistics.json").exists():
        recording, plan = folder / f"r{number}.spool", folder / f"plan{number}.toml"
        redrawn(scene, number, recording)
        plan.write_text(f'spp = [{BUDGETS}]\npictures = false\nsamplers = {json.dumps(scene.samplers.split(","))}\n'
                        f'filters = ["box", "directional"]\n[[dump]]\nfile = "{recording.name}"\ngroup = "scene"\n'
                        '[metrics]\nperceptual = "none"\n')
        done = run("evaluate", plan, "-o", results, "-q")
        if not (results / "statistics.json").exists():
            sys.exit(f"{folder.name} {number}: {done.stderr}")
        recording.unlink()
    if not (old / "statistics.json").exists():
        shutil.rmtree(old, ignore_errors=True)
        shutil.copytree(results, old)
        (old / "statistics.json").unlink()
        for file in (old / "cells").glob("*.jsonl"):
            cells = kept.cells_in(file.read_text())
            for cell in cells.values():
                cell.pop("halves", None)
                cell["fields"] = {k: v for k, v in cell["fields"].items() if not k.endswith("half_pixels")}
            file.write_text(kept.cells_text(cells))
        run("evaluate", "--statistics-only", old, "-q")
    return results, old


def counted(entry):
    return entry["filter"] == "box" or entry["sampler"].partition(":")[0] in ("uniform", "multiscale")


def rows_of(folders):
    """{row: [(mean, low, high) of each recording]}; without ends where there is no interval."""
    rows = {}
    for folder in folders:
        statistics = json.loads((folder / "statistics.json").read_text())
        for entry in filter(counted, statistics["results"]):
            method = f"{entry['sampler']} + {entry['filter']}"
            for name in QUANTITIES:
                rows.setdefault((name, method, entry["spp"]), []).append(entry["quantities"].get(name, []))
        for condition in statistics["conditions"]:
            if condition["metric"] in ("mse", "relmse"):
                for entry in filter(counted, condition["ranking"]):
                    if "ratio" in entry:
                        method = f"{entry['sampler']} + {entry['filter']}"
                        rows.setdefault((f"ratio of {condition['metric']}", method, condition["spp"]), []).append(entry["ratio"])
    return rows


def coverage(row, values):
    """(intervals, those that hold the mean of the others, of errors the geometric one, those wholly below it); none where most are withheld."""
    known = [value for value in values if value and value[0] > 0]
    if row[0] != "energy_ratio":
        known = [[math.log(v) if v > 0 else -math.inf for v in value] for value in known]
    means = [value[0] for value in known]
    found = [(low, (sum(means) - mean) / (len(means) - 1), high) for mean, low, high in (v for v in known if len(v) == 3)]
    if 2 * len(found) <= len(values):
        return 0, 0, 0
    return len(found), sum(low <= truth <= high for low, truth, high in found), sum(high < truth for _, truth, high in found)


def claims(folders, metric):
    """In how many families of comparisons of a method with itself something is claimed."""
    found = [json.loads(run("compare", a, b, "--metric", metric, "--json").stdout)["comparisons"] for a, b in zip(folders[::2], folders[1::2])]
    return sum(any(c["verdict"] in ("better", "worse") for c in family) for family in found)


def measure(name, folder):
    scene = SCENES[name]
    pairs = [evaluated(scene, number, folder) for number in range(scene.count)]
    now, before = ({row: coverage(row, values) for row, values in rows_of(side).items()} for side in zip(*pairs))
    selves = {f"itself_{metric}{end}": claims([pair[side] for pair in pairs], metric)
              for side, end in ((0, ""), (1, "_without")) for metric in ("mse", "relmse")}
    page.keep(name, {"side": scene.side, "samples": scene.samples, "recordings": scene.count, "measured": datetime.date.today().isoformat(),
                     **selves}, now, before)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(f"'{name}'" for name in SCENES))
    options = parser.parse_args()
    unknown = [name for name in options.scenes if name not in SCENES]
    if unknown:
        parser.error(f"'{unknown[0]}' is none of its scenes: --help lists them")
    return options


def main(options):
    for name in options.scenes or SCENES:
        folder = options.build / "coverage_results" / name.replace(", ", "_").replace(" ", "_")
        folder.mkdir(parents=True, exist_ok=True)
        measure(name, folder)
        page.write(SCENES)


if __name__ == "__main__":
    OPTIONS = parse()
    PROGRAM = OPTIONS.build.resolve() / "spool"
    main(OPTIONS)
