#!/usr/bin/env python3
"""Pictures of full size for docs/findings.md, in docs/images/full_size: one for each figure of the paper and recording.

    python3 -m tools.study.full_figures cornell_box_picture torus ...     by name, as recordings of full size lie on this machine
        [--figure e4 e5 e8 e9]   default: all that the recording has its use for
        [--crop X,Y,W,H]...      windows of e4 and e9; default: those of spool figure

Images that a picture is made of stay in build/full_figures: remove them to have them made again.

Columns are methods. e5 (Figure 9): samples of every sampler. e8 (Figures 11c-f): samples with tiles.
e4 (Figure 10), e9 (Figure 12): pictures with crops beside the reference.
"""
import argparse
import io
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle
from PIL import Image

import spool
import spool.exr
from tools.report.exr_image import rgb
from tools.report.figure_windows import choose_windows
from tools.report.result_images import Crop, exposure_and_mean, tone_mapped
from tools.study.plans import FULL, ROOT, full_recording

plt.switch_backend("Agg")
FOLDER = ROOT / "docs/images/full_size"
SAMPLERS = ("mitchell", "adaptive_wavelet", "greedy_error", "nl_means", "multiscale", "multiscale:paper", "neyman")
PAPER = {("multiscale:paper", "directional:paper"): "paper"}  # methods as {(sampler, filter): title}
DIRECTIONS = {("multiscale", f): f"multiscale,\n{title}" for f, title in (
    ("box", "no filter"), ("directional{anisotropy=none}", "isotropic"), ("directional{anisotropy=bank,bank_levels=3}", "bank, three stages"),
    ("directional", "directional"))} | PAPER
METHODS = {(s, f): f"{s} +\n{f}" for s, f in (
    ("uniform", "box"), ("mitchell", "multistage"), ("adaptive_wavelet", "wavelet_shrinkage"), ("greedy_error", "greedy_selection"),
    ("nl_means", "nl_means"))} | PAPER | {("multiscale", "directional"): "multiscale +\ndirectional"}
TILES = {"multiscale": "no tiles", **{f"multiscale{{parallel=tiles,tile={t}}}": f"tiles of {t}" for t in (64, 16)},
         "multiscale:paper{tile=64}": "paper, tiles of 64"}
FRAMES = ("#e69f00", "#56b4e9")


def save(figure, path):
    """A PNG of 256 colours, a third of the bytes; not dithered, which would be noise that no method made."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    plt.close(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.open(buffer).convert("RGB").quantize(256, dither=Image.Dither.NONE, kmeans=10).save(path, optimize=True)
    print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1000:.0f} kB", flush=True)


def grid(rows, columns, aspect, width=12.0, bar=0.08):
    """aspect: height of a panel over its width, of each row; bar: share of the width that a colour bar takes."""
    side = width / columns
    figure, axes = plt.subplots(rows, columns, figsize=(width, sum((1 - bar) * side * a + 0.25 for a in aspect[:rows])), squeeze=False, layout="constrained",
                                gridspec_kw={"height_ratios": aspect[:rows]})
    for axis in axes.flat:
        axis.set_xticks([])
        axis.set_yticks([])
    return figure, axes


class Pictures:
    def __init__(self, program, recording, folder, spp):
        self.program, self.recording, self.folder, self.spp = program, recording, folder, spp
        with spool.open(recording) as dump:
            self.reference = np.asarray(dump.pixel("reference"), dtype=np.float32)
        self.exposure = exposure_and_mean(self.reference)[0]
        self.aspect = self.reference.shape[0] / self.reference.shape[1]

    def _made(self, verb, name, *words):
        """A file named by what it holds: what is there already is not made again."""
        path = self.folder / (re.sub(r"[^\w.=-]+", "_", name) + ".exr")
        if not path.exists():
            subprocess.run([self.program, verb, self.recording, *words, "-o", path, "-q"], check=True, capture_output=True)
        return path

    def _counts(self, sampler):
        return self._made("replay", f"counts-{sampler}", "--sampler", sampler, "--spp", str(self.spp), "--order", "shuffled")

    def samples(self, sampler):
        return spool.exr.read(self._counts(sampler))["n"].astype(float)

    def image(self, sampler, filter_name):
        return rgb(spool.exr.read(self._made("reconstruct", f"image-{sampler}-{filter_name}", "--selection", self._counts(sampler),
                                             "--filter", filter_name)))

    def errors(self, image):
        """Every metric by its name."""
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder) / f"{name}.exr" for name in ("image", "reference")]
            for file, values in zip(files, (image, self.reference)):
                spool.exr.write(file, {c: np.ascontiguousarray(values[..., i]) for i, c in enumerate("RGB")})
            done = subprocess.run([self.program, "metrics", *files, "--json"], check=True, capture_output=True, text=True)
        return {name: found["value"] for name, found in json.loads(done.stdout)["metrics"].items()}

    def density(self, axis, counts, title):
        image = axis.imshow(counts, cmap="viridis", norm=LogNorm(max(1, self.spp / 8), self.spp * 8), interpolation="nearest")
        axis.set_title(title, fontsize=10)
        return image

    def photo(self, axis, image, title=""):
        axis.imshow(tone_mapped(image, self.exposure), interpolation="nearest")
        axis.set_title(title, fontsize=10)


def densities(p, rows, titles):
    """Samples of samplers, {sampler: title}; behind the reference where there is room for one more."""
    figure, axes = grid(rows, 4, [p.aspect] * rows)
    places = list(axes.flat)
    if len(titles) < len(places):
        p.photo(places[0], p.reference, "reference")
    for axis, (sampler, title) in zip(places[-len(titles):], titles.items()):
        density = p.density(axis, p.samples(sampler), title)
    figure.colorbar(density, ax=places, orientation="vertical", shrink=0.8, aspect=25, pad=0.01).set_label("samples of a pixel", fontsize=9)
    return figure


def beside(p, methods, crops):
    images = [p.image(*method) for method in methods]
    crops = crops or choose_windows(images, p.reference, p.exposure)
    figure, axes = grid(1 + len(crops), len(images) + 1, [p.aspect] + [1.0] * len(crops), width=1.5 * (len(images) + 1), bar=0.0)
    for column, (image, title) in enumerate(zip([*images, p.reference], [*methods.values(), "reference"])):
        p.photo(axes[0][column], image, title)
        for row, (x, y, width, height) in enumerate(crops):
            axes[0][column].add_patch(Rectangle((x - 0.5, y - 0.5), width, height, fill=False, edgecolor=FRAMES[row % 2], linewidth=1.2))
            below = axes[1 + row][column]
            p.photo(below, image[y:y + height, x:x + width])
            for spine in below.spines.values():
                spine.set(color=FRAMES[row % 2], linewidth=2)
        if column < len(images):
            found = p.errors(image)
            text = f"relMSE {found['relmse']:.2g}\ntrimmed {found['relmse_trimmed']:.2g}\nenergy {found['energy_ratio']:.3f}"
            axes[-1][column].set_xlabel(text, fontsize=9)
    return figure


# name: (samples per pixel, whether it has crops, what draws it)
FIGURES = {"e4": (8, True, lambda p, crops: beside(p, DIRECTIONS, crops)), "e5": (16, False, lambda p: densities(p, 2, {s: s for s in SAMPLERS})),
           "e8": (8, False, lambda p: densities(p, 1, TILES)), "e9": (8, True, lambda p, crops: beside(p, METHODS, crops))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", nargs="+")
    parser.add_argument("--figure", nargs="+", choices=list(FIGURES))
    parser.add_argument("--crop", action="append")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    arguments = parser.parse_args()
    crops = [Crop(*map(int, text.split(","))) for text in arguments.crop or []]
    for name in arguments.recordings:
        path = full_recording(arguments.program, name, ROOT / "build/experiments_full/pools")
        if path is None:
            sys.exit(f"full_figures: {name} is not here: tools/dev.sh record {name}")
        chosen = arguments.figure or (["e8"] if name in FULL["analytic"] and name.endswith("_512") else ["e4", "e5", "e9"])
        for figure in chosen:
            spp, cropped, draw = FIGURES[figure]
            folder = ROOT / "build/full_figures" / f"{name}_{path.stat().st_mtime_ns}_{spp}"
            folder.mkdir(parents=True, exist_ok=True)
            pictures = Pictures(arguments.program, path, folder, spp)
            save(draw(pictures, crops) if cropped else draw(pictures), FOLDER / f"{figure}_{name}.png")


if __name__ == "__main__":
    main()
