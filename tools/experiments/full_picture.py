#!/usr/bin/env python3
"""Makes docs/images/full_size.png: what a few samples give on a recording of full size, and where they went.

    tools/experiments/full_picture.py [RECORDING.spool] [--crop X,Y,SIDE]...

Columns: uniform samples as they are; multiscale samples with the project's own filter; the reference; the density of the
samples; the level of the filter that `directional` chose. Rows: the picture, then crops. Errors stand under the columns.
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import LogNorm  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402

from full_size import RECORDINGS  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats" / "python"))
import spool  # noqa: E402
import spool.exr  # noqa: E402

SPP = "8"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
CROPS = ["96,140,48", "170,190,48"]


def rgb(path):
    layers = spool.exr.read(path)
    return np.stack([layers[c].astype(np.float64) for c in "RGB"], axis=-1)


def shown(image, exposure):
    linear = np.clip(image * exposure, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def settings_of(kind, method):
    """(name with preset, --set arguments) of a method with options: name{a=1,b=2}."""
    name, _, options = method.partition("{")
    pairs = [part for part in options.removesuffix("}").split(",") if part]
    return name, [word for pair in pairs for word in ("--set", f"{kind}.{pair}")]


class Runs:
    """The program's files in a folder."""

    def __init__(self, program, recording, folder, spp=SPP):
        self.program, self.recording, self.folder, self.spp = program, recording, folder, str(spp)

    def spool(self, *arguments):
        return subprocess.run([self.program, *arguments], check=True, capture_output=True, text=True).stdout

    def target(self, *words):
        """A file named by what it holds: what is there already is not made again."""
        return self.folder / (re.sub(r"[^\w.=-]+", "_", "-".join(map(str, words))) + ".exr")

    def replay(self, sampler, *more):
        """Of a shuffled order: the counts, and views that `more` asks for."""
        name, settings = settings_of("sampler", sampler)
        target = self.target("counts", sampler, *more)
        if not target.exists():
            self.spool("replay", self.recording, "--sampler", name, *settings, "--spp", self.spp, "--order", "shuffled", "-o", target, "-q", *more)
        return target

    def image(self, counts, filter_name, *more):
        name, settings = settings_of("filter", filter_name)
        target = self.target("image", counts.stem, filter_name)
        if not target.exists():
            self.spool("reconstruct", self.recording, "--selection", counts, "--filter", name, *settings, "-o", target, "-q", *more)
        return target


def reference_of(recording):
    with spool.open(recording) as dump:
        values = np.asarray(dump.pixel("reference"), dtype=np.float64)
    return np.moveaxis(values, 0, -1) if values.shape[0] == 3 else values


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", nargs="?", default=RECORDINGS / "cornell_box_picture.spool", type=Path)
    parser.add_argument("--crop", action="append", help=f"default: {' '.join(CROPS)}")
    parser.add_argument("--exposure", type=float, help="factor of the radiance; default: the 95th percentile becomes 0.9")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("-o", "--output", default=ROOT / "docs/images/full_size.png", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        runs = Runs(arguments.program, arguments.recording, Path(scratch))
        uniform, adaptive = runs.replay("uniform"), runs.replay("multiscale")
        noisy, ours = rgb(runs.image(uniform, "box")), rgb(runs.image(adaptive, "twin_guides"))
        runs.image(adaptive, "directional", "--pictures", Path(scratch) / "pictures")
        counts = spool.exr.read(adaptive)["n"].astype(np.float64)
        sizes = next(iter(spool.exr.read(Path(scratch) / "pictures" / "filter_size.exr").values()))
    reference = reference_of(arguments.recording)
    draw(arguments, noisy, ours, reference, counts, sizes)


def relative_errors(image, reference):
    """(relmse, relmse_trimmed) as in docs/results.md: both images divided by the reference's mean luminance, then the second without
    the worst 0.1 % of the pixels. The reference's own noise is not taken off."""
    unit = (reference @ LUMINANCE).mean()
    errors = np.sort(np.mean(((image - reference) / unit) ** 2 / ((reference / unit) ** 2 + 0.01), axis=-1).ravel())
    return float(errors.mean()), float(errors[:errors.size - int(np.ceil(0.001 * errors.size))].mean())


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
        axes[-1][column].set_xlabel(f"relMSE {relative_errors(image, reference)[0]:.2g}, energy {image.sum() / reference.sum():.3f}", fontsize=11)
    for column in (3, 4):
        figure.colorbar(axes[0][column].images[0], ax=axes[0][column], orientation="horizontal", shrink=0.8, aspect=30)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(arguments.output, dpi=100)


if __name__ == "__main__":
    main()
