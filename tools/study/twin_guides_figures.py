"""Figures of twin_guides on one scale beside those of its prototype: twin_guides_figures.py PROGRAM.

The prototype is plain numpy in double, written before the filter and apart from it; it takes the same samples, the first of each
pixel in recorded order. docs/results/twin_guides/prototype.csv has its figures: squared error over (reference^2 + 0.01), the mean over
channels and pixels, all and without the largest 0.1 %; and the energy ratio. The program judges the filter by the same. Prints a table;
exit code 1 where one differs by more than 3 %.
"""
import csv
import sys
import tempfile
from pathlib import Path

from tools.study.plans import ROOT
from tools.study.replays import Runs, errors, reference_of, rgb

PROTOTYPE = ROOT / "docs/results/twin_guides/prototype.csv"
NAMES = {"relmse_trimmed": "relmse_trimmed", "relmse": "relmse", "energy": "energy_ratio"}
METHOD = "twin_guides{scales=1,agreement=0,clamp_sigma=2}"
MOST = 0.03  # of difference, relative


def main():
    program = Path(sys.argv[1]).resolve()
    ratios = {name: [] for name in NAMES}
    print("| recording | spp | " + " | ".join(f"{name}: filter, prototype" for name in NAMES) + " |")
    print("|---" * (len(NAMES) + 2) + "|")
    with tempfile.TemporaryDirectory() as folder, open(PROTOTYPE, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            recording = ROOT / "dumps/tiny" / (row["recording"] + ".spool")
            runs = Runs(program, recording, Path(folder), row["spp"], "recorded")
            image = rgb(runs.image(runs.replay("uniform"), METHOD))
            found = errors(program, image, reference_of(recording), settings=["rel_scale=none"])
            cells = []
            for name, metric in NAMES.items():
                ratios[name].append(found[metric] / float(row[name]))
                cells.append(f"{found[metric]:.4f}, {float(row[name]):.4f}")
            print(f"| {row['recording']} | {row['spp']} | " + " | ".join(cells) + " |")
    for name, values in ratios.items():
        print(f"{name}: filter / prototype {min(values):.4f} .. {max(values):.4f}")
    return int(any(abs(v - 1) > MOST for values in ratios.values() for v in values))


if __name__ == "__main__":
    sys.exit(main())
