"""twin_guides beside Open Image Denoise: twin_guides_sizes.py PROGRAM RECORDING... [--spp 8] [--set scales=1]...

Needs the library of Open Image Denoise (docs/own_methods.md). Both get the first samples of each pixel in recorded order. The program judges
them: trimmed relMSE with rel_scale=none, what the reference's own noise adds taken off. Of the three ways to call OIDN
(colour alone, with albedo and normal, with both prefiltered) the one with the smallest error counts: picked with the reference.
Prints a line for each recording: error of OIDN, then for each --set (and without one) error over that and energy ratio.
"""
import argparse
import tempfile
from pathlib import Path

from tools.study.replays import Runs, errors, reference_of, rgb, spool

OIDN = "oidn{features=off}", "oidn{prefilter=off}", "oidn"


def line(program, recording, spp, choices, folder):
    reference, runs = reference_of(recording), Runs(program, recording, folder, spp, "recorded")
    with spool.open(recording) as dump:
        samples = dump.read("radiance", count=spp).astype(float)
        variance = samples.var(axis=2, ddof=1) / dump.meta["reference"]["samples"]

    def judged(method):
        return errors(program, rgb(runs.image(runs.replay("uniform"), method)), reference, variance, ["rel_scale=none"])

    oidn = min(judged(method)["relmse_trimmed"] for method in OIDN)
    cells = [recording.stem, "x".join(map(str, reference.shape[1::-1])), f"{oidn:.5f}"]
    for settings in choices:
        found = judged(f"twin_guides{{{settings}}}")
        cells.append(f"{found['relmse_trimmed'] / oidn:.3f} / {found['energy_ratio']:.3f}")
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
