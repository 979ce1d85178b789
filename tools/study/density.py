"""Where a sampler puts its samples: replays the samplers of a plan and measures the density.

Measures of a replay, one number per replicate:
  level_K          share of the samples of pops that a pop of level K took
  levels_3_4       of levels 3 and 4 together: the largest regions, of which the highest alone is often 0
  correlation      Pearson correlation of the count with the deviation of all recorded samples, over pixels
  tile_jump        mean |difference of counts| across the borders of the sampler's tiles / elsewhere
Results have block_jump and edge_share themselves.
"""
import itertools
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import spool
import spool.exr
from tools.report.whole_file import write_whole
from tools.study.plans import PLANS, methods_of

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def jump(counts, step):
    """Mean jump across the borders of blocks of `step` pixels, relative to jumps elsewhere."""
    across, elsewhere = [], []
    for image in (counts, counts.T):
        steps = np.abs(np.diff(image, axis=1))
        border = (np.arange(1, image.shape[1]) % step) == 0
        across.append(steps[:, border].ravel())
        elsewhere.append(steps[:, ~border].ravel())
    across, elsewhere = np.concatenate(across), np.concatenate(elsewhere)
    if across.size == 0 or elsewhere.mean() == 0:
        return None
    return float(across.mean() / elsewhere.mean())


def deviation_of(path):
    """Of the samples of each pixel of a recording."""
    with spool.open(path) as dump:
        return (np.asarray(dump.read("radiance"), dtype=np.float64) @ LUMINANCE).std(axis=2)


def measure(counts, log, deviation, tile):
    found = {}
    if counts.min() < counts.max():
        found["correlation"] = float(np.corrcoef(counts.ravel(), deviation.ravel())[0, 1])
    popped = sum(log["samples_of_level"])
    for level, samples in enumerate(log["samples_of_level"]):
        if level and popped:
            found[f"level_{level}"] = samples / popped
    if popped:
        found["levels_3_4"] = sum(log["samples_of_level"][3:5]) / popped
    if tile:
        found["tile_jump"] = jump(counts, tile)
    return found


def replay(program, pool, name, options, spp, seed):
    with tempfile.TemporaryDirectory() as folder:
        selection = Path(folder) / "n.exr"
        settings = [part for option, value in options.items() for part in ("--set", f"sampler.{option}={value}")]
        finished = subprocess.run(
            [program, "replay", pool, "--sampler", name, *settings, "--spp", str(spp), "--order", "shuffled",
             "--seed", str(seed), "--json", "-q", "-o", selection], check=True, capture_output=True, text=True)
        return spool.exr.read(selection)["n"].astype(np.float64), json.loads(finished.stdout)


def densities(program, plan, folder):
    """{recording: {"SAMPLER|SPP": {measure: [one per replicate]}}} of a plan; what is done is kept in the folder."""
    store = folder / "density_cells.json"
    done = json.loads(store.read_text()) if store.exists() else {}
    found = {}
    for path in plan["recordings"]:
        path = PLANS / path
        deviation = None
        for label, name, options in methods_of(plan, "sampler"):
            for spp, seed in itertools.product(plan["spp"], range(1, plan["replicates"] + 1)):
                key = f"{path.stem}|{label}|{spp}|{seed}"
                if key not in done:
                    deviation = deviation_of(path) if deviation is None else deviation
                    counts, log = replay(program, path, name, options, spp, seed)
                    done[key] = measure(counts, log, deviation, options.get("tile"))
                    write_whole(store, json.dumps(done))
                for column, value in done[key].items():
                    if value is not None:
                        found.setdefault(path.stem, {}).setdefault(f"{label}|{spp:g}", {}).setdefault(column, []).append(value)
    return found
