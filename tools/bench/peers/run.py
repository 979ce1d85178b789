"""tools/dev.sh bench peers: programs of others and ours, in one run on one picture; writes a section of docs/speed.md."""
import argparse
import csv
import json
import os
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt

from tools.bench.speed_page import ROOT, replace_section
from tools.study.plans import CACHE
from tools.study.tables import markdown

plt.switch_backend("svg")
RESULTS = ROOT / "docs" / "results" / "peers"
IMAGES = {"filter": "filter of 8 uniform samples", "pair": "sampler and filter, 8 of 64 samples"}  # kinds that give an image, which has an error
OIDN = "Open Image Denoise, albedo and normal"


def peers_python():
    return os.environ.get("SPOOL_PEERS_PYTHON") or CACHE / "peers-venv" / "bin" / "python"


def measure(build, arguments):
    done = subprocess.run([peers_python(), "-m", "tools.bench.peers.subjects", build / "spool", str(arguments.size),
                           str(arguments.turns), str(arguments.longest), arguments.without], env={**os.environ, "PYTHONPATH": str(build.resolve() / "python")}, check=True, cwd=ROOT,
                          stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


def table(rows, kind):
    """Costs as multiples of Open Image Denoise's."""
    one = next(r for r in rows if r["name"] == OIDN)
    return markdown([IMAGES[kind], one["unit"], f"times {one['name']}", "relMSE", "MSE", "energy"],
                    [[r["name"], f"{r['cost']:.3g}", f"{r['cost'] / one['cost']:.2g}", f"{r['relmse']:.3g}", f"{r['mse']:.3g}", f"{r['energy']:.3f}"]
                     for r in sorted((r for r in rows if r["kind"] == kind), key=lambda r: r["cost"])])


def draw(rows, path):
    """Two errors against cost, all logarithmic; every filter has a number, cheapest first, and its name beside the panels."""
    plt.rcParams["svg.fonttype"], plt.rcParams["svg.hashsalt"] = "path", "spool"
    figure, panels = plt.subplots(2, 1, figsize=(10, 9), sharex=True)
    shown = sorted((r for r in rows if r["kind"] in IMAGES), key=lambda r: r["cost"])
    for axes, (metric, name) in zip(panels, (("relmse", "relMSE"), ("mse", "MSE"))):
        for i, row in enumerate(shown):
            ours = row["name"].startswith("spool")
            axes.plot(row["cost"], row[metric], "s" if not ours else "o" if row["kind"] == "filter" else "D", color="#0072b2" if ours else "#d55e00",
                      fillstyle="none" if row["kind"] == "pair" else "full")
            axes.annotate(i + 1, (row["cost"], row[metric]), textcoords="offset points", fontsize=8, xytext=(0, 5 if i % 2 else -12), ha="center")
        axes.set(xscale="log", yscale="log", ylabel=f"{name} at 8 samples a pixel")
        axes.grid(True, which="both", alpha=0.25)
    panels[-1].set_xlabel("CPU seconds per megapixel, one thread")
    figure.tight_layout(rect=(0, 0, 0.72, 1))
    names = "\n".join(f"{i + 1:2}  {row['name'].removeprefix('spool: ').replace('Open Image Denoise', 'OIDN')}" for i, row in enumerate(shown))
    figure.text(0.73, 0.98, names, va="top", fontsize=9, linespacing=1.6)
    figure.savefig(path, metadata={"Date": None}, facecolor="white")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    parser.add_argument("--size", type=int, default=512, help="pixels a side, a multiple of 64")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--longest", type=float, default=30, help="seconds; what takes longer runs in the first turn only")
    parser.add_argument("--without", default="^$", help="leave out subjects whose name this regular expression finds")
    arguments = parser.parse_args()
    found = measure(arguments.build.resolve(), arguments)
    RESULTS.mkdir(parents=True, exist_ok=True)
    with open(RESULTS / "peers.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, ["kind", "name", "cost", "unit", "relmse", "mse", "energy"])
        writer.writeheader()
        writer.writerows(found["rows"])
    draw(found["rows"], RESULTS / "peers.svg")
    side = found["side"]
    replace_section("peers", "\n\n".join([
        "## Beside other programs",
        f"`tools/dev.sh bench peers`: {side} x {side} pixels of mirrored copies of `dumps/tiny/chess.spool`, 8 of 64 samples, one thread, the "
        f"least CPU time of {found['turns']} turns in which every subject ran (what took longer than {arguments.longest:g} s: once). Compare ratios: seconds are those of one "
        "machine. Peers get the mean image, and the noise where they ask for it; ours read the samples. In the figure discs are our filters of uniform samples, "
        "squares those of others, empty diamonds a sampler and a filter of ours together; numbers are in the order of cost.",
        "![error against CPU time](results/peers/peers.svg)",
        *(table(found["rows"], kind) for kind in IMAGES),
        "Samplers, reading, packing and judging beside other programs: [peers.csv](results/peers/peers.csv)."]))


if __name__ == "__main__":
    main()
