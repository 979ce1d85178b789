#!/usr/bin/env python3
"""What a smaller reference costs: errors of 4 samples a pixel, judged by references of 256 to 4096 samples.

    python3 tools/bench/recorders/reference_price.py build/release/spool

The references are drawn around those of the recordings, which count as exact: normal numbers of the variance that n samples would
have, by pixel and channel, correlated as the channels of a pixel are taken to be (fully). Printed for each n: CPU seconds of the recorder,
the noise of relMSE's denominator, and how far debiased MSE and relMSE are off, root mean square of 16 draws, in per cent.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
for folder in ("dumps/recording", "formats/python"):
    sys.path.insert(0, os.path.join(ROOT, folder))

import spool  # noqa: E402
from reference_need import EPSILON, denominator_noise  # noqa: E402
from spool import exr  # noqa: E402

SCENES, COUNTS, DRAWS, FILTERS = ("chess", "balls", "table", "fireflies"), (256, 512, 1024, 2048, 4096), 16, ("box", "directional")


def image_of(program, path, name, folder):
    out = os.path.join(folder, name + ".exr")
    subprocess.run([program, "reconstruct", path, "--spp", "4", "--filter", name, "-o", out, "--force", "-q"], check=True)
    channels = exr.read(out)
    return np.stack([channels[c] for c in "RGB"], axis=-1).astype(float)


def errors(image, reference, variance):
    """(debiased MSE, debiased relMSE)"""
    squared = (image - reference) ** 2 - variance
    return squared.mean(), (squared / (reference ** 2 + EPSILON)).mean()


def main():
    program = sys.argv[1]
    print("| scene | samples | CPU | denominator | %s |" % " | ".join("%s of %s" % (m, f) for f in FILTERS for m in ("MSE", "relMSE")))
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            path = os.path.join(ROOT, "dumps", "tiny", scene + ".spool")
            with spool.open(path) as dump:
                exact, variance = (dump.pixel(name).astype(float) for name in ("reference", "reference_variance"))
                samples, cost = dump.meta["reference"]["samples"], dump.meta["cost_per_sample"] * dump.width * dump.height
            images = [image_of(program, path, name, folder) for name in FILTERS]
            random = np.random.default_rng(1)
            for count in COUNTS:
                own = variance * samples / count
                off = []
                for _ in range(DRAWS):
                    drawn = exact + np.sqrt(own) * random.standard_normal((*exact.shape[:2], 1))
                    off.append([judged / true - 1 for image in images
                                for judged, true in zip(errors(image, drawn, own), errors(image, exact, 0))])
                off = np.sqrt((np.array(off) ** 2).mean(axis=0))
                print("| `%s` | %d | %.0f s | %.2g | %s |" % (scene, count, cost * count, denominator_noise(exact, own),
                                                         " | ".join("%.2g %%" % (100 * v) for v in off)), flush=True)


if __name__ == "__main__":
    main()
