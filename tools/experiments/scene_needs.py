#!/usr/bin/env python3
"""Measures what a recording's layers cost and what they buy, for docs/scene_needs.md.

    tools/experiments/scene_needs.py              records four scenes three times, 64 x 64 pixels with 64 samples
    tools/experiments/scene_needs.py --write-only the two parts of the page, from what is there

Recordings with fewer layers hold the same radiance, bit by bit: the table says so where they do not.
"""
import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from results import Results
from tables import table, with_interval
from whole_file import with_part, write_whole

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats" / "python"))
import spool  # noqa: E402

FEATURES = ("albedo", "normal", "depth")
SCENES = {  # name: (renderer, arguments)
    "chess": ("Cycles", ["chess", "--mode", "shift", "--seed", "1"]),
    "table": ("Cycles", ["table", "--mode", "iid", "--seed", "1"]),
    "mist": ("Cycles", ["mist", "--mode", "iid", "--seed", "1"]),
    "caustic_mitsuba": ("Mitsuba", ["caustic", "--seed", "1"]),
}
SETS = {"radiance": ["radiance"], "film": ["radiance", "film"], "features": ["radiance", *FEATURES]}
WITH_FILM = ("chess", "caustic_mitsuba")     # Cycles tells positions only where it shifts whole pictures
SIZE, SAMPLES, REFERENCE, SPP, REPLICATES = 64, 64, 1024, 8, 8
# Methods that read a layer, each with the same method where the layer is missing.
READERS = {"film": ["greedy_selection", "directional{recon_granularity=sample}"],
           "features": ["cross_bilateral", "twin_guides"]}
METHODS = ["box", "gaussian", "greedy_selection", "directional", "directional{recon_granularity=sample}", "cross_bilateral",
           "nl_means", "twin_guides"]


def sets_of(scene):
    return {name: layers for name, layers in SETS.items() if name != "film" or scene in WITH_FILM}


def recorder(renderer):
    if renderer == "Cycles":
        return [ROOT / "dumps" / "record.sh"]
    cache = Path(os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache"))) / "spool"
    python = os.environ.get("SPOOL_MITSUBA_PYTHON", cache / "mitsuba-venv" / "bin" / "python")
    return [python, ROOT / "dumps" / "mitsuba" / "record.py"]


def record(scene, layers, out):
    renderer, arguments = SCENES[scene]
    subprocess.run([*recorder(renderer), *arguments, "--size", f"{SIZE}x{SIZE}", "--samples", str(SAMPLES), "--reference",
                    str(REFERENCE), "--channels", ",".join(layers), "--no-verify", "-o", out], check=True,
                   stdout=subprocess.DEVNULL)


def info(program, path):
    return json.loads(subprocess.run([program, "info", path, "--json"], check=True, capture_output=True, text=True).stdout)


def radiance(path):
    with spool.open(path) as dump:
        return np.asarray(dump.read("radiance"))


def bytes_of(layers):
    """Bytes of a sample before compression."""
    return sum(len(layer["components"]) * (2 if layer["type"] == "f16" else 4) for layer in layers if layer["scope"] == "sample")


def cost_rows(program, folder):
    rows = []
    for scene, (renderer, _) in SCENES.items():
        alone = info(program, folder / f"{scene}_radiance.spool")
        first = radiance(folder / f"{scene}_radiance.spool")
        for name in sets_of(scene):
            path = folder / f"{scene}_{name}.spool"
            found = info(program, path)
            same = np.array_equal(first, radiance(path))
            rows.append([scene, renderer, " ".join(SETS[name]), f"{bytes_of(found['layers'])}", f"{found['bytes'] / 1e6:.2f}",
                         f"{found['cost_per_sample'] / alone['cost_per_sample']:.2f}", "yes" if same else "**no**"])
    return rows


def evaluate(program, folder):
    dumps = [folder / f"{scene}_{name}.spool" for scene in SCENES for name in sets_of(scene)]
    subprocess.run([program, "evaluate", *dumps, "--samplers", "uniform", "--filters", ",".join(METHODS), "--spp", str(SPP),
                    "--replicates", str(REPLICATES), "--no-pictures", "-q", "-o", folder / "results"], stdout=subprocess.DEVNULL)


def gain_rows(results):
    """relMSE of methods that read a layer, with it and without."""
    rows = []
    for layer, filters in READERS.items():
        for name in filters:
            for scene in (s for s in SCENES if layer in sets_of(s)):
                without, with_it = (results.figure("relmse", f"{scene}_{kind}", "uniform", name, SPP) for kind in ("radiance", layer))
                best = min((results.figure("relmse", f"{scene}_radiance", "uniform", m, SPP).mean, m) for m in METHODS
                           if results.rows(f"{scene}_radiance", "uniform", m, SPP))
                rows.append([layer, name, scene, with_interval(without), with_interval(with_it), f"{best[1]} {best[0]:.3g}"])
    return rows


COST = """## What a layer costs

Written by `tools/experiments/scene_needs.py`: {size} x {size} pixels, {samples} samples, the same seeds. Bytes of a sample are those
before compression; the file has the reference, too. A film position that is the same for a whole pass of Cycles is kept once a
pass. Time is the renderer's for a sample, relative to radiance alone recorded just before; a busy machine moves it by a fifth.

{cost}
"""
GAIN = """## What it buys

relMSE of {spp} uniform samples, geometric mean over {replicates} replicates with its 95 % interval, judged by an independent
reference of {reference} samples. The last column is the best method that needs radiance alone.

{gain}

A method that cannot do without a layer is refused where it is missing ("–"). Film positions say where in its pixel a sample fell: of
the methods of the program only those in the table look at them, so the recorders of most scenes may leave them out.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--folder", default=ROOT / "build/scene_needs", type=Path, help="of recordings and results")
    parser.add_argument("--write-only", action="store_true")
    parser.add_argument("-o", "--output", default=ROOT / "docs/scene_needs.md", type=Path)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    if not arguments.write_only:
        for scene in SCENES:
            for name, layers in sets_of(scene).items():
                out = arguments.folder / f"{scene}_{name}.spool"
                if not out.exists():
                    record(scene, layers, out)
        evaluate(arguments.program, arguments.folder)
    cost = table(["scene", "renderer", "layers", "bytes a sample", "file, MB", "time of a sample", "the same radiance"],
                 cost_rows(arguments.program, arguments.folder))
    gain = table(["layer", "method", "scene", "without it", "with it", "best of radiance alone"],
                 gain_rows(Results([arguments.folder / "results"])))
    page = arguments.output.read_text(encoding="utf-8")
    for text in (COST.format(cost=cost, size=SIZE, samples=SAMPLES), GAIN.format(gain=gain, spp=SPP, replicates=REPLICATES, reference=REFERENCE)):
        page = with_part(page, text.partition("\n")[0], text)
    write_whole(arguments.output, page)


if __name__ == "__main__":
    main()
