#!/usr/bin/env python3
"""Makes the pictures of docs/method.md from a recording: rows of views as `spool` writes them.

    python3 -m tools.study.method_pictures [--program build/release/spool] [--output docs/images/method]

Debian's Python, which has OpenImageIO. A test makes them again and compares every pixel.
"""
import argparse
import subprocess
import tempfile
from pathlib import Path

import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[2]
RECORDING = ROOT / "dumps/tiny/table.spool"
PANEL, GAP = 192, 6  # pixels: three to a pixel of the recording; grey between the panels
SAMPLER, FILTER = "sampler", "filter"
ROWS = {  # file: (who hands the views over, their names)
    "coarse": (SAMPLER, ["f.0", "f.1", "f.2", "f.3", "f.4"]),
    "detail": (SAMPLER, ["d.0", "d.1", "d.2", "d.3"]),
    "priority_initial": (SAMPLER, ["P_initial.1", "P_initial.2", "P_initial.3", "P_initial.4"]),
    "attenuation": (SAMPLER, ["A.1", "A.2", "A.3", "A.4"]),
    "density": (SAMPLER, ["n", "samples.1", "samples.2", "samples.3", "samples.4"]),
    "size": (FILTER, ["T.0", "T.1", "T.2", "T.3", "level"]),
    "direction": (FILTER, ["band_energy.2.0", "band_energy.2.2", "band_energy.2.4", "band_energy.2.6",
                           "dominant_direction"]),
    "width": (FILTER, ["delta.0", "delta.2", "delta.4", "delta.6"]),
}


def wanted(stage):
    """Families of views: "f" for "f.0", "f.1"."""
    return ",".join({name.split(".")[0]: None for who, names in ROWS.values() if who == stage for name in names})


def run(program, folder):
    """The folders in which the views of the sampler and of the filter lie."""
    counts = folder / "n.exr"
    subprocess.run([program, "replay", RECORDING, "--sampler", "multiscale", "--spp", "16", "--views", wanted(SAMPLER),
                    "--pictures", folder / "sampler", "-o", counts], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, "reconstruct", RECORDING, "--selection", counts, "--filter", "directional", "--views",
                    wanted(FILTER), "--pictures", folder / "filter", "-o", folder / "image.exr"],
                   check=True, stdout=subprocess.DEVNULL)
    return {SAMPLER: folder / "sampler", FILTER: folder / "filter" / "views"}


def row_of(panels):
    width = len(panels) * (PANEL + GAP) - GAP
    row = oiio.ImageBuf(oiio.ImageSpec(width, PANEL, 3, "uint8"))
    oiio.ImageBufAlgo.fill(row, (0.5, 0.5, 0.5))
    for i, path in enumerate(panels):
        if not path.exists():
            raise SystemExit(f"{path.name}: the program made no such view")
        panel = oiio.ImageBufAlgo.channels(oiio.ImageBuf(str(path)), (0, 1, 2))
        small = oiio.ImageBufAlgo.resample(panel, interpolate=False, roi=oiio.ROI(0, PANEL, 0, PANEL))
        oiio.ImageBufAlgo.paste(row, i * (PANEL + GAP), 0, 0, 0, small)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--output", default=ROOT / "docs/images/method", type=Path)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        folders = run(arguments.program, Path(scratch))
        for name, (stage, views) in ROWS.items():
            row = row_of([folders[stage] / f"{view}.png" for view in views])
            if not row.write(str(arguments.output / f"{name}.png")):
                raise SystemExit(f"{arguments.output / name}.png: {row.geterror()}")


if __name__ == "__main__":
    main()
