"""Figures of twin_guides on one scale beside those of its prototype: twin_guides_figures.py PROGRAM.

The prototype is plain numpy in double, written before the filter and apart from it; it takes the same samples, the first of each
pixel in recorded order. docs/results/twin_guides/prototype.csv has its figures. Both are judged here: squared error over
(reference^2 + 0.01), the mean over channels and pixels, all and without the largest 0.1 %; and the energy ratio. Prints a table;
exit code 1 where one differs by more than 3 %.
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats/python"))
import spool  # noqa: E402

PROTOTYPE = ROOT / "docs/results/twin_guides/prototype.csv"
NAMES = ("relmse_trimmed", "relmse", "energy")
MOST = 0.03  # of difference, relative


def figures(image, reference):
    errors = ((image - reference) ** 2 / (reference ** 2 + 0.01)).mean(axis=-1).ravel()
    dropped = int(np.ceil(0.001 * errors.size))
    return dict(zip(NAMES, (np.sort(errors)[:-dropped].mean(), errors.mean(), image.mean() / reference.mean())))


def filtered(program, recording, spp, folder):
    selection, image = folder / f"{recording.stem}_{spp}_n.exr", folder / f"{recording.stem}_{spp}.exr"
    subprocess.run([program, "replay", recording, "--sampler", "uniform", "--spp", str(spp), "-q", "-o", selection],
                   check=True)
    subprocess.run([program, "reconstruct", recording, "--selection", selection, "--filter", "twin_guides", "--set",
                    "twin_guides.scales=1", "--set", "twin_guides.agreement=0", "--set", "twin_guides.clamp_sigma=2", "-q", "-o", image], check=True)
    return np.asarray(oiio.ImageBuf(str(image)).get_pixels(oiio.FLOAT), dtype=float)[..., :3]


def main():
    program = Path(sys.argv[1]).resolve()
    ratios = {name: [] for name in NAMES}
    print("| recording | spp | " + " | ".join(f"{name}: filter, prototype" for name in NAMES) + " |")
    print("|---" * (len(NAMES) + 2) + "|")
    with tempfile.TemporaryDirectory() as folder, open(PROTOTYPE, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            recording = ROOT / "dumps/tiny" / (row["recording"] + ".spool")
            with spool.open(recording) as dump:
                reference = dump.pixel("reference").astype(float)[..., :3]
            ours = figures(filtered(program, recording, int(row["spp"]), Path(folder)), reference)
            for name in NAMES:
                ratios[name].append(ours[name] / float(row[name]))
            cells = [f"{ours[name]:.4f}, {float(row[name]):.4f}" for name in NAMES]
            print(f"| {row['recording']} | {row['spp']} | " + " | ".join(cells) + " |")
    for name in NAMES:
        values = np.array(ratios[name])
        print(f"{name}: filter / prototype {values.min():.4f} .. {values.max():.4f}, geometric mean "
              f"{np.exp(np.log(values).mean()):.4f}")
    return int(any(abs(np.array(ratios[name]) - 1).max() > MOST for name in NAMES))


if __name__ == "__main__":
    sys.exit(main())
