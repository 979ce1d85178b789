"""Writes docs/coverage.md, how often 95 % intervals hold another recording: tools/dev.sh bench coverage [RECORDINGS].

Every world is redrawn as many times; each redrawn recording is evaluated by the program as a user does it, and its intervals
are held against the mean of the others. What is done is not done again (build/coverage_results).
"""
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

import spool

ROOT = Path(__file__).resolve().parents[3]

PAGE = ROOT / "docs" / "coverage.md"
TINY = ("balls", "caustic", "caustic_mitsuba", "chess", "fireflies", "mist", "table")
SAMPLERS = "uniform,mitchell,adaptive_wavelet,greedy_error,nl_means,neyman,multiscale"
ORACLE = "neyman"  # decides by the whole recording
SAMPLES, BUDGETS = 64, "4,8,16"
QUANTITIES = ("mse", "relmse", "energy_ratio")

TEXT = """# How often the 95 % intervals hold the truth

Written by `tools/dev.sh bench coverage`. Each recording of `dumps/tiny`, and scene S, was made {count} times: every sample drawn with
replacement from the recorded ones (64 x 64 pixels, {samples} samples, the mean of the recording as exact reference). Each was evaluated
as `spool evaluate` does it by default, 8 replicates, {budgets} samples: {samplers} with `box`; `uniform` and `multiscale` with
`directional`. A row is the mean of MSE, relMSE or energy, or a ratio of MSE or relMSE to `uniform` + `box`, of one method at one budget.
Its interval should hold the mean of the other {others} recordings in 95 %. Of {count} trials a row that is right lies below 90 % by chance in
{chance:.0f} of 100. Rows are *withheld* where most of their recordings have no verdict
because few pixels carry the error ([decision 156](decisions.md#0156-what-a-verdict-may-stand-on)); "without halves" are the same results with the
spread between recordings assumed and not measured ([decision 155](decisions.md#0155-the-spread-between-recordings-is-measured-on-halves-of-the-recording)), nothing withheld.

{table}

Below 80 %:

{low}

## A method compared with itself

`spool compare` of two recordings of one scene: {methods} methods, {budgets} samples, one family of comparisons for each metric. Nothing
differs, so 5 % of families may claim something.

{selves}

## What forbids more

- `neyman`, an oracle, is left out of both tables: it takes samples where the whole recording varies, so its halves share what they know, and in
  relMSE on balls and caustic its differences between recordings are claimed in half of the families.
- Light that few samples carry: a recording that holds none of them does not know of it, and its interval is too narrow. Three recordings
  or more (`--recordings`, `group`) show it.
- Where samples have a tail of infinite variance, the expectation of the squared error does not exist, and no interval can hold it
  [BahadurSavage56].
- Where one cell of the image carries an error, its spread is known with one degree of freedom, and the interval is 3 to 15 times as wide
  as it had to be.
"""


def redrawn(world, number, folder):
    """The path of redrawn recording `number`."""
    path = folder / f"r{number}.spool"
    if path.exists():
        return path
    if world == "scene_s":
        run("synth", "scene_s", "--size", 64, "--samples", SAMPLES, "--seed", 1000 + number, "-o", path, "-q")
        return path
    recorded = spool.open(ROOT / "dumps" / "tiny" / f"{world}.spool")
    radiance = recorded.read("radiance")
    height, width, count = radiance.shape[:3]
    chosen = np.random.default_rng(1000 + number).integers(0, count, (height, width, SAMPLES))
    features = {name: np.take_along_axis(layer, chosen if layer.ndim == 3 else chosen[..., None], axis=2)
                for name in recorded.layers if name in ("albedo", "normal", "depth") for layer in [recorded.read(name)]}
    spool.write(path, np.take_along_axis(radiance, chosen[..., None], axis=2).astype(np.float32), sample_order="exchangeable",
                reference=radiance.astype(np.float64).mean(2).astype(np.float32), force=True, **features)
    return path


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=False, capture_output=True, text=True)


def evaluated(world, number, folder):
    """The folder of its results; and the same with halves left out."""
    results = folder / f"results{number}"
    if not (results / "statistics.json").exists():
        recording = redrawn(world, number, folder)
        plan = folder / f"plan{number}.toml"
        plan.write_text(f'spp = [{BUDGETS}]\npictures = false\nsamplers = {json.dumps(SAMPLERS.split(","))}\n'
                        f'filters = ["box", "directional"]\n[[dump]]\nfile = "{recording.name}"\ngroup = "{world}"\n'
                        '[metrics]\nperceptual = "none"\n')
        done = run("evaluate", plan, "-o", results, "-q")
        if not (results / "statistics.json").exists():
            sys.exit(f"{world} {number}: {done.stderr}")
    old = folder / f"old{number}"
    if not old.exists():
        shutil.copytree(results, old)
        for cell in (old / "cells").glob("*.json"):
            data = json.loads(cell.read_text())
            data.pop("halves", None)
            for name in [n for n in data["fields"] if n.endswith("half_pixels")]:
                data["fields"].pop(name)
            cell.write_text(json.dumps(data))
        run("evaluate", "--statistics-only", old, "-q")
    return results, old


def counted(entry):
    if entry["sampler"] == ORACLE:
        return False
    return entry["filter"] == "box" or entry["sampler"] in ("uniform", "multiscale")


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


def coverage(values):
    """Share of the intervals that hold the geometric mean of the others; None where most are withheld."""
    logs = [[math.log(v) if v > 0 else -math.inf for v in value] for value in values if value and value[0] > 0]
    means = [value[0] for value in logs]
    held = [low <= (sum(means) - mean) / (len(means) - 1) <= high for mean, low, high in (v for v in logs if len(v) == 3)]
    return sum(held) / len(held) if len(held) > len(values) / 2 else None


def by_chance(count):
    """Chance that fewer than 90 % of `count` intervals hold where each does with 95 %."""
    return sum(math.comb(count, k) * 0.95 ** k * 0.05 ** (count - k) for k in range(math.ceil(0.9 * count)))


def claims(folders, metric):
    """In how many families of comparisons of a method with itself something is claimed, and of how many."""
    found = [json.loads(run("compare", a, b, "--metric", metric, "--json").stdout)["comparisons"] for a, b in zip(folders[::2], folders[1::2])]
    return sum(any(c["verdict"] in ("better", "worse") and ORACLE not in c["combination"] for c in family) for family in found), len(found)


def main():
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    table = ["| scene | rows | 90 % and more | below | withheld | least | below without halves | least |", "|---|---|---|---|---|---|---|---|"]
    selves = ["| scene | MSE | relMSE | MSE without halves | relMSE without halves |", "|---|---|---|---|---|"]
    low, methods = [], 0
    for world in ("scene_s", *TINY):
        folder = Path(sys.argv[1]) / "coverage_results" / world
        folder.mkdir(parents=True, exist_ok=True)
        pairs = [evaluated(world, number, folder) for number in range(count)]
        now, before = (rows_of(side) for side in zip(*pairs))
        found = {row: coverage(values) for row, values in now.items()}
        old = [c for values in before.values() if (c := coverage(values)) is not None]
        held = [c for c in found.values() if c is not None]
        methods = len({method for _, method, _ in now})
        table.append(f"| {world} | {len(found)} | {sum(c >= 0.9 for c in held)} | {sum(c < 0.9 for c in held)} | {len(found) - len(held)} "
                     f"| {100 * min(held):.0f} % | {sum(c < 0.9 for c in old)} | {100 * min(old):.0f} % |")
        low += [f"- {world}: {name} of {method}, {spp:g} samples: {100 * found[name, method, spp]:.0f} %"
                for name, method, spp in found if found[name, method, spp] is not None and found[name, method, spp] < 0.8]
        cells = ["{} of {}".format(*claims([pair[side] for pair in pairs], metric)) for side in (0, 1) for metric in ("mse", "relmse")]
        selves.append(f"| {world} | {' | '.join(cells)} |")
        print(table[-1], selves[-1], sep="\n", flush=True)
    PAGE.write_text(TEXT.format(count=count, others=count - 1, samples=SAMPLES, budgets=BUDGETS.replace(",", ", "), methods=methods,
                                samplers=", ".join(f"`{s}`" for s in SAMPLERS.split(",")), chance=100 * by_chance(count),
                                table="\n".join(table), low="\n".join(low) or "- none", selves="\n".join(selves)), encoding="utf-8")


PROGRAM = Path(sys.argv[1]) / "spool"

if __name__ == "__main__":
    main()
