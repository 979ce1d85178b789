#!/usr/bin/env python3
"""What layers cost and buy on recordings of full size, for docs/scene_needs.md: kept by recording, as their results are (measured.py).

    tools/experiments/scene_needs_full.py NAME...       measures those that are here and writes the page's part
    tools/experiments/scene_needs_full.py --write-only  the part, from all that was measured on any machine

A recording of full size is made once, with all its layers. What it would be without some is the same file without them: the samples of a
seed do not depend on the layers (scene_needs.py checks that by recording). The time of a layer is that of short recordings, 16 samples
and no more reference than must be, of the same picture; the median of three.
"""
import argparse
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from full_size import ROOT, Recordings  # noqa: E402
from results import Results  # noqa: E402
from scene_needs import READERS, bytes_of, info  # noqa: E402
from tables import pool_title, table, with_interval  # noqa: E402
from whole_file import with_last_part, write_whole  # noqa: E402

# Behind the folders that are there: dumps has a pools.py of its own.
sys.path += [str(ROOT / "formats/python"), str(ROOT / "dumps"), str(ROOT / "dumps/recording"), str(ROOT / "dumps/verify")]
import spool  # noqa: E402
from pool_run import command_of  # noqa: E402

SCENES = os.environ.get("SPOOL_SCENES", os.path.join(os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "spool", "scenes"))
STORE = ROOT / "docs/results/scene_needs"
SETS = {"radiance": ("radiance",), "film": ("radiance", "film"), "lens": ("radiance", "lens"), "features": ("radiance", "albedo", "normal", "depth")}
PLAIN = ("box", "directional", "nl_means", "twin_guides", "greedy_selection")
SPP, REPLICATES, SHORT, TURNS = 8, 4, 16, 3
TITLE = "## At full size"


def without(source, layers, target):
    """The recording with these layers of samples alone, and its reference; made once."""
    if target.exists():
        return
    with spool.open(source) as dump:
        read = {"sample": dump.read, "pixel": dump.pixel, "pass": dump.passes}
        kept = [layer for layer in dump.layers.values() if layer.name in layers or layer.scope == "pixel"]
        spool.write(target, **{layer.name: np.asarray(read[layer.scope](layer.name)) for layer in kept},
                    scope={layer.name: layer.scope for layer in kept}, meta=dump.meta, sample_order=dump.sample_order, compress=True)


def seconds_of(pool, kind, folder):
    """CPU microseconds of a sample: the median of short recordings; None where the renderer is not here."""
    found, layers = [], SETS[kind]
    for turn in range(TURNS):
        out = str(folder / f"short_{kind}_{turn}.spool")
        short = {**pool, "samples": SHORT, "reference": SHORT, "arguments": [*pool["arguments"], "--channels", ",".join(layers), "--no-verify"]}
        short.pop("scene_sha256", None)
        if not os.path.exists(out) and subprocess.run(command_of(short, out, SCENES), cwd=ROOT, capture_output=True).returncode:
            return None
        with spool.open(out) as dump:
            found.append(1e6 * dump.meta["cost_per_sample"])
    return sorted(found)[TURNS // 2]


def gains(program, files, folder):
    """{set: {filter: [mean, low, high]}} of relMSE from uniform samples."""
    filters = [*PLAIN, *(f for readers in READERS.values() for f in readers)]
    subprocess.run([program, "evaluate", *files.values(), "--samplers", "uniform", "--filters", ",".join(dict.fromkeys(filters)), "--spp", str(SPP),
                    "--replicates", str(REPLICATES), "--no-pictures", "-q", "-o", folder / "results"], stdout=subprocess.DEVNULL)
    results = Results([folder / "results"])
    return {name: {f: results.figure("relmse", path.stem, "uniform", f, SPP)[:3] for f in dict.fromkeys(filters)
                   if results.rows(path.stem, "uniform", f, SPP)} for name, path in files.items()}


def measure(program, name, recordings):
    listed = tomllib.loads((ROOT / "dumps/POOLS.toml").read_text())["pool"]
    pool, source = next(p for p in listed if p["name"] == name), recordings.path(name)
    with spool.open(source) as dump:
        there = set(dump.layers)
    sets = {kind: layers for kind, layers in SETS.items() if set(layers) <= there}
    folder = ROOT / "build/scene_needs_full" / f"{name}_{recordings.hash(name)[:8]}"  # what is there is not made again
    folder.mkdir(parents=True, exist_ok=True)
    files = {kind: folder / f"{kind}.spool" for kind in sets}
    for kind, path in files.items():
        without(source, sets[kind], path)
    found = {"recording": name, "renderer": pool["renderer"], "size": pool["size"], "samples": pool["samples"],
             "samples_sha256": recordings.hash(name),
             "sets": {kind: {"layers": sets[kind], "bytes": bytes_of(info(program, path)["layers"]), "file": path.stat().st_size,
                             "microseconds": seconds_of(pool, kind, folder)} for kind, path in files.items()},
             "relmse": gains(program, files, folder)}
    STORE.mkdir(parents=True, exist_ok=True)
    write_whole(STORE / f"{name}.json", json.dumps(found, indent=1) + "\n")


def cost_rows(found):
    rows = []
    for one in found:
        alone = one["sets"]["radiance"]
        for kind in one["sets"].values():
            known = kind["microseconds"] and alone["microseconds"]
            rows.append([pool_title(one["recording"]), one["renderer"], " ".join(kind["layers"]), str(kind["bytes"]), f"{kind['file'] / 1e6:.0f}",
                         f"{kind['file'] / alone['file']:.2f}", f"{kind['microseconds'] / alone['microseconds']:.2f}" if known else "–"])
    return rows


def gain_rows(found):
    from inference import interval_of
    rows = []
    for layer, filters in READERS.items():
        for f in filters:
            for one in (o for o in found if layer in o["sets"]):
                plain, more = one["relmse"]["radiance"], one["relmse"][layer]
                best = min((v[0], m) for m, v in plain.items())
                rows.append([layer, f, pool_title(one["recording"]), *(with_interval(interval_of(values.get(f, []))) for values in (plain, more)),
                             f"{best[1]} {best[0]:.3g}"])
    return rows


def part():
    found = [json.loads(path.read_text()) for path in sorted(STORE.glob("*.json"))]
    if not found:
        return TITLE + "\n\nNot measured yet.\n"
    return "\n\n".join([
        TITLE, "Written by `tools/experiments/scene_needs_full.py` from what was measured on any machine (`docs/results/scene_needs`); pictures of "
        f"256 x 256 pixels, 256 samples, compressed; the file has the reference, too. Time is that of short recordings of the same picture "
        f"({SHORT} samples, median of {TURNS}, relative to radiance alone); a busy machine moves it by a fifth.",
        table(["recording", "renderer", "layers", "bytes a sample", "file, MB", "relative", "time of a sample"], cost_rows(found)),
        f"relMSE of {SPP} uniform samples, geometric mean over {REPLICATES} replicates with its 95 % interval; the last column is the best of the methods "
        "here that needs radiance alone.",
        table(["layer", "method", "recording", "without it", "with it", "best of radiance alone"], gain_rows(found))]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--write-only", action="store_true")
    parser.add_argument("-o", "--output", default=ROOT / "docs/scene_needs.md", type=Path)
    arguments = parser.parse_args()
    recordings = Recordings(arguments.program, ROOT / "build/experiments_full")
    for name in () if arguments.write_only else arguments.names:
        measure(arguments.program.resolve(), name, recordings)
    write_whole(arguments.output, with_last_part(arguments.output.read_text(encoding="utf-8"), TITLE, part()))


if __name__ == "__main__":
    main()
