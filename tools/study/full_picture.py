#!/usr/bin/env python3
"""Makes docs/images/full_size.png: what a few samples give on a recording of full size, and where they went.

    python3 -m tools.study.full_picture [RECORDING.spool] [--crop X,Y,SIDE]...

Columns: uniform samples as they are; multiscale samples with the project's own filter; the reference; the density of the
samples; the level of the filter that `directional` chose. Rows: the picture, then crops. Errors stand under the columns.
"""
import argparse
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle

from tools.study.plans import RECORDINGS, ROOT
from tools.study.replays import Runs, errors, reference_of, rgb, spool

plt.switch_backend("Agg")
SPP = "8"
CROPS = ["96,140,48", "170,190,48"]


def shown(image, exposure):
    linear = np.clip(image * exposure, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", nargs="?", default=RECORDINGS / "cornell_box_picture.spool", type=Path)
    parser.add_argument("--crop", action="append", help=f"default: {' '.join(CROPS)}")
    parser.add_argument("--exposure", type=float, help="factor of the radiance; default: the 95th percentile becomes 0.9")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("-o", "--output", default=ROOT / "docs/images/full_size.png", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        runs = Runs(arguments.program, arguments.recording, Path(scratch), SPP)
        uniform, adaptive = runs.replay("uniform"), runs.replay("multiscale")
        noisy, ours = rgb(runs.image(uniform, "box")), rgb(runs.image(adaptive, "twin_guides"))
        runs.image(adaptive, "directional", "--pictures", Path(scratch) / "pictures")
        counts = spool.exr.read(adaptive)["n"].astype(np.float64)
        sizes = next(iter(spool.exr.read(Path(scratch) / "pictures" / "filter_size.exr").values()))
    reference = reference_of(arguments.recording)
    draw(arguments, noisy, ours, reference, counts, sizes)


def draw(arguments, noisy, ours, reference, counts, sizes):
    exposure = arguments.exposure or 0.9 / np.percentile(reference, 95)
    crops = [tuple(map(int, text.split(","))) for text in arguments.crop or CROPS]
    columns = [(f"{SPP} uniform samples", shown(noisy, exposure), {}),
               (f"{SPP} multiscale samples, twin_guides", shown(ours, exposure), {}),
               ("reference", shown(reference, exposure), {}),
               ("samples of a pixel", counts, {"cmap": "viridis", "norm": LogNorm(max(1, counts.min()), counts.max())}),
               ("level of the directional filter", sizes, {"cmap": "magma", "vmin": 0, "vmax": sizes.max()})]
    height, width = counts.shape
    figure, axes = plt.subplots(1 + len(crops), len(columns), figsize=(15, 15 / len(columns) * (height / width + len(crops)) + 0.4),
                                squeeze=False, layout="constrained")
    for column, (title, image, style) in enumerate(columns):
        axes[0][column].set_title(title, fontsize=11)
        axes[0][column].imshow(image, interpolation="nearest", **style)
        for row, (x, y, side) in enumerate(crops):
            box = Rectangle((x - 0.5, y - 0.5), side, side, fill=False, edgecolor=("#e69f00", "#56b4e9")[row % 2], linewidth=1.5)
            axes[0][column].add_patch(box)
            below = axes[1 + row][column]
            below.imshow(image, interpolation="nearest", **style)
            below.set_xlim(x - 0.5, x + side - 0.5)
            below.set_ylim(y + side - 0.5, y - 0.5)
            for spine in below.spines.values():
                spine.set(color=("#e69f00", "#56b4e9")[row % 2], linewidth=2)
    for axis in axes.flat:
        axis.set_xticks([])
        axis.set_yticks([])
    for column, image in ((0, noisy), (1, ours)):
        found = errors(arguments.program, image, reference)
        axes[-1][column].set_xlabel(f"relMSE {found['relmse']:.2g}, energy {found['energy_ratio']:.3f}", fontsize=11)
    for column in (3, 4):
        figure.colorbar(axes[0][column].images[0], ax=axes[0][column], orientation="horizontal", shrink=0.8, aspect=30)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(arguments.output, dpi=100)


if __name__ == "__main__":
    main()
