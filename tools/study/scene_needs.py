#!/usr/bin/env python3
"""Measures what layers and needs of a recording cost and what they buy, and writes docs/scene_needs.md.

    python3 -m tools.study.scene_needs small           records four scenes with several sets of layers, 64 x 64 pixels
    python3 -m tools.study.scene_needs needs           records scenes of Cycles with a need (lens, shutter, medium) and without it
    python3 -m tools.study.scene_needs full NAME...    recordings of full size that are here, without some of their layers
    python3 -m tools.study.scene_needs                 the page alone, from what is kept in docs/results/scene_needs

What is recorded is not recorded again: build/scene_needs. Errors and intervals are the program's.
"""
import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import tomllib

from tools.study import tables
from tools.study.plans import CACHE, ROOT, full_recording
from tools.study.replays import errors, reference_of, spool
from tools.study.whole_file import write_whole

# Behind the folders that are there: recordings has a pools.py of its own.
sys.path += [str(ROOT / "dumps"), str(ROOT / "dumps/recording"), str(ROOT / "dumps/verify")]

STORE, SCRATCH = ROOT / "docs/results/scene_needs", ROOT / "build/scene_needs"
FEATURES = ("albedo", "normal", "depth")
SETS = {"radiance": ("radiance",), "film": ("radiance", "film"), "lens": ("radiance", "lens"), "features": ("radiance", *FEATURES)}
# Methods that read a layer; the others need radiance alone.
READERS = {"film": ("greedy_selection", "directional{recon_granularity=sample}"), "features": ("cross_bilateral", "twin_guides")}
METHODS = ("box", "gaussian", "greedy_selection", "directional", "directional{recon_granularity=sample}", "cross_bilateral", "nl_means",
           "twin_guides")
SMALL = {  # scene: (renderer, arguments, sets); Cycles gives positions only where it shifts whole pictures
    "chess": ("Cycles", ["chess", "--mode", "shift", "--seed", "1"], ("radiance", "film", "features")),
    "table": ("Cycles", ["table", "--mode", "iid", "--seed", "1"], ("radiance", "features")),
    "mist": ("Cycles", ["mist", "--mode", "iid", "--seed", "1"], ("radiance", "features")),
    "caustic_mitsuba": ("Mitsuba", ["caustic", "--seed", "1"], ("radiance", "film", "features")),
}
CASES = (("chess", "lens"), ("balls", "lens"), ("balls", "time"), ("mist", "medium"))
NEEDS = {"lens": "a point on the lens", "time": "a moment of the shutter", "medium": "a way through a medium"}
TURNS = 3  # times are the middle one


def recorder(renderer):
    if renderer == "Cycles":
        return [ROOT / "dumps/record.sh"]
    return [os.environ.get("SPOOL_MITSUBA_PYTHON", CACHE / "mitsuba-venv/bin/python"), ROOT / "dumps/mitsuba/record.py"]


def record(out, command, size, reference, layers):
    if not out.exists():
        subprocess.run([*command, "--size", f"{size}x{size}", "--samples", "64", "--reference", str(reference), "--channels",
                        ",".join(layers), "--no-verify", "-o", out], check=True, stdout=subprocess.DEVNULL)


def info(program, path):
    return json.loads(subprocess.run([program, "info", path, "--json"], check=True, capture_output=True, text=True).stdout)


def bytes_of(layers):
    """Bytes of a sample before compression."""
    return sum(len(layer["components"]) * (2 if layer["type"] == "f16" else 4) for layer in layers if layer["scope"] == "sample")


def relmse(program, dumps, filters, replicates, folder):
    """{recording: {filter: [mean, low, high]}} of 8 uniform samples."""
    subprocess.run([program, "evaluate", *dumps, "--samplers", "uniform", "--filters", ",".join(filters), "--spp", "8", "--replicates",
                    str(replicates), "--no-pictures", "-q", "-o", folder], stdout=subprocess.DEVNULL)
    found = {}
    for entry in json.loads((folder / "statistics.json").read_text())["results"]:
        if "relmse" in entry.get("quantities", {}):
            found.setdefault(tables.recording(entry["dump"]), {})[entry["filter"]] = entry["quantities"]["relmse"]
    return found


def keep(name, found):
    STORE.mkdir(parents=True, exist_ok=True)
    write_whole(STORE / f"{name}.json", json.dumps(found, indent=1) + "\n")


def measure_small(program):
    files = {(scene, kind): SCRATCH / f"{scene}_{kind}.spool" for scene, (_, _, kinds) in SMALL.items() for kind in kinds}
    for (scene, kind), path in files.items():
        renderer, arguments, _ = SMALL[scene]
        record(path, [*recorder(renderer), *arguments], 64, 1024, SETS[kind])
    gains = relmse(program, list(files.values()), METHODS, 8, SCRATCH / "small")
    rows = []
    for scene, (renderer, _, kinds) in SMALL.items():
        sets = {}
        for kind in kinds:
            path = files[scene, kind]
            found = info(program, path)
            with spool.open(path) as dump, spool.open(files[scene, "radiance"]) as alone:
                same = bool(np.array_equal(np.asarray(dump.read("radiance")), np.asarray(alone.read("radiance"))))
            sets[kind] = {"layers": SETS[kind], "bytes": bytes_of(found["layers"]), "file": path.stat().st_size,
                          "microseconds": 1e6 * found["cost_per_sample"], "same_radiance": same}
        rows.append({"recording": scene, "renderer": renderer, "sets": sets, "relmse": {k: gains[f"{scene}_{k}"] for k in kinds}})
    keep("small", rows)


def measure_needs(program):
    dumps, names = {}, dict.fromkeys([*((scene, "nothing") for scene, _ in CASES), *CASES])
    for turn in range(TURNS):  # turn by turn, so that other work on the machine meets them all
        for scene, need in names:
            blend, out = SCRATCH / f"{scene}_{need}.blend", SCRATCH / f"{scene}_{need}_{turn + 1}.spool"
            if not blend.exists():
                subprocess.run(["blender", "-b", "--factory-startup", "-P", Path(__file__).with_name("blend_without.py"), "--python-exit-code", "3",
                                "--", scene, need, blend], check=True, capture_output=True)
            judges = turn == 0 or (turn == 1 and need == "nothing")  # of the others only the time is asked
            record(out, [*recorder("Cycles"), blend, "--mode", "iid", "--seed", str(turn + 1)], 128, 1024 if judges else 64, ["radiance"])
            dumps.setdefault((scene, need), []).append(out)
    noise = relmse(program, [found[0] for found in dumps.values()], ["box"], 8, SCRATCH / "needs")
    middle = {name: sorted(1e6 * info(program, d)["cost_per_sample"] for d in found)[TURNS // 2] for name, found in dumps.items()}
    rows = []
    for scene, need in CASES:
        whole, without = dumps[scene, "nothing"], dumps[scene, need]
        reference, again = map(reference_of, whole[:2])
        rows.append({"scene": scene, "need": need, "microseconds": middle[scene, "nothing"], "microseconds_without": middle[scene, need],
                     "noise": noise[whole[0].stem]["box"], "noise_without": noise[without[0].stem]["box"],
                     "left_out": errors(program, reference_of(without[0]), reference)["relmse"],
                     "again": errors(program, again, reference)["relmse"]})
    keep("left_out", {"size": 128, "samples": 64, "reference": 1024, "spp": 8, "rows": rows})


def without(source, layers, target):
    """The recording with these layers of samples alone, and its reference; made once."""
    if target.exists():
        return
    with spool.open(source) as dump:
        read = {"sample": dump.read, "pixel": dump.pixel, "pass": dump.passes}
        kept = [layer for layer in dump.layers.values() if layer.name in layers or layer.scope == "pixel"]
        spool.write(target, **{layer.name: np.asarray(read[layer.scope](layer.name)) for layer in kept},
                    scope={layer.name: layer.scope for layer in kept}, meta=dump.meta, sample_order=dump.sample_order, compress=True)


def seconds_of(pool, layers, folder, kind):
    """CPU microseconds of a sample in short recordings; None where the renderer is not here."""
    from pool_run import command_of
    found = []
    for turn in range(TURNS):
        out = str(folder / f"short_{kind}_{turn}.spool")
        short = {**pool, "samples": 16, "reference": 16, "arguments": [*pool["arguments"], "--channels", ",".join(layers), "--no-verify"]}
        short.pop("scene_sha256", None)
        command = command_of(short, out, os.environ.get("SPOOL_SCENES", str(CACHE / "scenes")))
        if not os.path.exists(out) and subprocess.run(command, cwd=ROOT, capture_output=True).returncode:
            return None
        with spool.open(out) as dump:
            found.append(1e6 * dump.meta["cost_per_sample"])
    return sorted(found)[TURNS // 2]


def measure_full(program, name):
    from content_hash import content_hash
    source = full_recording(program, name, ROOT / "build/experiments_full/pools")
    if source is None:
        sys.exit(f"scene_needs: {name} is not here: tools/dev.sh record {name}")
    pool = next(p for p in tomllib.loads((ROOT / "dumps/POOLS.toml").read_text())["pool"] if p["name"] == name)
    with spool.open(source) as dump:
        sets = {kind: layers for kind, layers in SETS.items() if set(layers) <= set(dump.layers)}
    hashed = content_hash(source)
    folder = SCRATCH / f"{name}_{hashed[:8]}"
    folder.mkdir(parents=True, exist_ok=True)
    files = {kind: folder / f"{kind}.spool" for kind in sets}
    for kind, path in files.items():
        without(source, sets[kind], path)
    costs = {kind: {"layers": sets[kind], "bytes": bytes_of(info(program, path)["layers"]), "file": path.stat().st_size,
                    "microseconds": seconds_of(pool, sets[kind], folder, kind)} for kind, path in files.items()}
    keep(name, {"recording": name, "renderer": pool["renderer"], "size": pool["size"], "samples": pool["samples"], "samples_sha256": hashed,
                "sets": costs, "relmse": relmse(program, list(files.values()), METHODS, 4, folder / "results")})


COSTS = ["recording", "renderer", "layers", "bytes a sample", "file, MB", "relative", "time of a sample"]
GAINS = ["layer", "method", "recording", "without it", "with it", "best of radiance alone"]


def cost_rows(found):
    rows = []
    for one in found:
        alone = one["sets"]["radiance"]
        for kind in one["sets"].values():
            known = kind["microseconds"] and alone["microseconds"]
            other = "" if kind.get("same_radiance", True) else " (other radiance)"
            rows.append([one["recording"], one["renderer"], " ".join(kind["layers"]) + other, kind["bytes"], f"{kind['file'] / 1e6:.3g}",
                         f"{kind['file'] / alone['file']:.2f}", f"{kind['microseconds'] / alone['microseconds']:.2f}" if known else "–"])
    return rows


def gain_rows(found):
    """relMSE of methods that read a layer, with it and without, beside the best of those that need radiance alone."""
    rows = []
    for layer, filters in READERS.items():
        for name in filters:
            for one in (o for o in found if layer in o["sets"]):
                plain, more = one["relmse"]["radiance"], one["relmse"][layer]
                best = min((v[0], m) for m, v in plain.items())
                rows.append([layer, name, one["recording"], tables.interval(plain.get(name)), tables.interval(more.get(name)),
                             f"{best[1]} {best[0]:.3g}"])
    return rows


def need_table(found):
    rows = [[r["scene"], NEEDS[r["need"]], f"{r['microseconds'] / r['microseconds_without']:.2f}", tables.interval(r["noise_without"]),
             tables.interval(r["noise"]), tables.number(max(0.0, r["left_out"] - r["again"])), tables.number(r["again"])] for r in found["rows"]]
    return tables.markdown(["scene", "a sample needs", "time of a sample", "noise without it", "noise with it", "left out", "two references"], rows)


def pages():
    """{file beside the page: its text}: the page, and the long tables as CSV."""
    kept = {path.stem: json.loads(path.read_text()) for path in sorted(STORE.glob("*.json"))}
    needs, small = kept.pop("left_out"), kept.pop("small")
    text = (Path(__file__).parent / "templates/scene_needs.in").read_text(encoding="utf-8")
    found = [*small, *kept.values()]
    sizes = ["64 x 64"] * len(small) + ["full"] * len(kept)
    return {"scene_needs.md": text.replace("{{need}}", need_table(needs)),
            **{f"results/scene_needs/{name}.csv": tables.as_csv(["size", *header], [[size, *row] for size, one in zip(sizes, found) for row in rows([one])])
               for name, header, rows in (("costs", COSTS, cost_rows), ("gains", GAINS, gain_rows))}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", choices=["small", "needs", "full"])
    parser.add_argument("names", nargs="*", help="of recordings of full size")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("-o", "--output", default=ROOT / "docs", type=Path, help="folder of the pages")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    SCRATCH.mkdir(parents=True, exist_ok=True)
    if arguments.what == "small":
        measure_small(program)
    if arguments.what == "needs":
        measure_needs(program)
    for name in arguments.names:
        measure_full(program, name)
    for name, text in pages().items():
        write_whole(arguments.output / name, text)


if __name__ == "__main__":
    main()
