"""twin_guides beside Open Image Denoise: twin_guides_sizes.py PROGRAM RECORDING... [--spp 8] [--set scales=1]...

Needs the library of Open Image Denoise (docs/own_methods.md). Both get the first samples of each pixel in recorded order. Judged here as in twin_guides_figures.py,
without the largest 0.1 % of the errors; what the reference's own noise adds is taken off both. Of the three ways to call OIDN
(colour alone, with albedo and normal, with both prefiltered) the one with the smallest error counts: picked with the reference.
Prints a line for each recording: error of OIDN, then for each --set (and without one) error over that and energy ratio.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats/python"))
import spool  # noqa: E402
from spool import exr  # noqa: E402

OIDN = "oidn{features=off}", "oidn{prefilter=off}", "oidn"


def without_largest(errors):
    errors = np.sort(errors.mean(axis=-1), axis=None)
    return errors[:errors.size - int(np.ceil(0.001 * errors.size))].mean()


class Judge:
    def __init__(self, dump, samples):
        self.reference = dump.pixel("reference").astype(float)[..., :3]
        self.weight = 1 / (self.reference ** 2 + 0.01)
        count = dump.meta["reference"]["samples"]
        self.floor = without_largest(samples.var(axis=2, ddof=1) / count * self.weight)

    def error(self, image):
        return without_largest((image - self.reference) ** 2 * self.weight) - self.floor

    def energy(self, image):
        return image.mean() / self.reference.mean()


def filtered(program, recording, spp, method, folder):
    selection, image = folder / "n.exr", folder / "image.exr"
    subprocess.run([program, "replay", recording, "--sampler", "uniform", "--spp", str(spp), "-q", "--force", "-o", selection], check=True)
    subprocess.run([program, "reconstruct", recording, "--selection", selection, "--filter", method, "-q", "--force", "-o", image], check=True)
    planes = exr.read(image)
    return np.stack([planes[c] for c in "RGB"], axis=-1).astype(float)


def line(program, recording, spp, choices, folder):
    with spool.open(recording) as dump:
        judge = Judge(dump, dump.read("radiance", count=spp).astype(float))
    oidn = min(judge.error(filtered(program, recording, spp, method, folder)) for method in OIDN)
    cells = [recording.stem, "x".join(map(str, judge.reference.shape[1::-1])), f"{oidn:.5f}"]
    for settings in choices:
        image = filtered(program, recording, spp, f"twin_guides{{{settings}}}", folder)
        cells.append(f"{judge.error(image) / oidn:.3f} / {judge.energy(image):.3f}")
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--spp", type=int, default=8)
    parser.add_argument("--set", action="append", default=[], help="options of the filter, a column each: scales=1,slack=3")
    arguments = parser.parse_args()
    choices = ["", *arguments.set]
    print("| recording | size | OIDN | " + " | ".join(c or "defaults" for c in choices) + " |")
    print("|---" * (len(choices) + 3) + "|")
    with tempfile.TemporaryDirectory() as folder:
        for recording in arguments.recordings:
            cells = line(arguments.program.resolve(), recording, arguments.spp, choices, Path(folder))
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
