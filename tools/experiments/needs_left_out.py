#!/usr/bin/env python3
"""What a need of a scene costs the renderer and what leaving it out does to the picture, for docs/scene_needs.md.

    tools/experiments/needs_left_out.py              records scenes of Cycles with a need and without it, and writes the page's part
    tools/experiments/needs_left_out.py --write-only the part, from what was measured (docs/results/scene_needs/left_out.json)
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from full_picture import reference_of, relative_errors  # noqa: E402
from full_size import ROOT  # noqa: E402
from results import Results  # noqa: E402
from scene_needs import info  # noqa: E402
from tables import number, table, with_interval  # noqa: E402
from whole_file import with_part, write_whole  # noqa: E402

STORE = ROOT / "docs/results/scene_needs/left_out.json"
CASES = (("chess", "lens"), ("balls", "lens"), ("balls", "time"), ("mist", "medium"))
SHOWN = {"lens": "a point on the lens (depth of field)", "time": "a moment of the shutter (motion blur)", "medium": "a way through a medium (mist)"}
SIZE, SAMPLES, REFERENCE, SPP, REPLICATES, TURNS = 128, 64, 1024, 8, 8, 3
TITLE = "## What a need costs"


def recorded(folder, scene, need, seed, reference):
    """The dump; made once."""
    blend, dump = folder / f"{scene}_{need}.blend", folder / f"{scene}_{need}_{seed}.spool"
    if not blend.exists():
        subprocess.run(["blender", "-b", "--factory-startup", "-P", Path(__file__).with_name("blend_without.py"), "--python-exit-code", "3", "--",
                        scene, need, blend], check=True, capture_output=True)
    if not dump.exists():
        subprocess.run([ROOT / "dumps/record.sh", blend, "--mode", "iid", "--seed", str(seed), "--size", f"{SIZE}x{SIZE}", "--samples", str(SAMPLES),
                        "--reference", str(reference), "--channels", "radiance", "--no-verify", "-o", dump], check=True, stdout=subprocess.DEVNULL)
    return dump


def cost(program, dumps):
    """CPU microseconds of a sample: the median."""
    return sorted(1e6 * info(program, dump)["cost_per_sample"] for dump in dumps)[len(dumps) // 2]


def noise(program, folder, dumps):
    """{name of the dump: relMSE of uniform samples with its interval}"""
    subprocess.run([program, "evaluate", *dumps, "--samplers", "uniform", "--filters", "box", "--spp", str(SPP), "--replicates", str(REPLICATES),
                    "--no-pictures", "-q", "-o", folder / "results"], check=True, stdout=subprocess.DEVNULL)
    results = Results([folder / "results"])
    return {pool: list(results.figure("relmse", pool, "uniform", "box", SPP)[:3]) for pool in results.pools}


def measure(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    # Turn by turn, so that other work on the machine meets them all.
    names = dict.fromkeys([*((scene, "nothing") for scene, _ in CASES), *CASES])
    dumps = {name: [] for name in names}
    for turn in range(TURNS):
        for name, found in dumps.items():
            judges = turn == 0 or (turn == 1 and name[1] == "nothing")  # of the others only the time is asked
            found.append(recorded(folder, *name, turn + 1, REFERENCE if judges else SAMPLES))
    errors = noise(program, folder, [found[0] for found in dumps.values()])
    rows = []
    for scene, need in CASES:
        whole, without = dumps[scene, "nothing"], dumps[scene, need]
        reference, again = map(reference_of, whole[:2])
        rows.append({"scene": scene, "need": need, "microseconds": cost(program, whole), "microseconds_without": cost(program, without),
                     "noise": errors[whole[0].stem], "noise_without": errors[without[0].stem],
                     "left_out": relative_errors(reference_of(without[0]), reference)[0], "again": relative_errors(again, reference)[0]})
    write_whole(STORE, json.dumps({"size": SIZE, "samples": SAMPLES, "reference": REFERENCE, "spp": SPP, "rows": rows}, indent=1) + "\n")


def part():
    from inference import interval_of
    found = json.loads(STORE.read_text())
    rows = [[r["scene"], SHOWN[r["need"]], f"{r['microseconds'] / r['microseconds_without']:.2f}", with_interval(interval_of(r["noise_without"])),
             with_interval(interval_of(r["noise"])), number(max(0.0, r["left_out"] - r["again"])), number(r["again"])] for r in found["rows"]]
    return "\n\n".join([
        TITLE, f"Written by `tools/experiments/needs_left_out.py`: scenes of Cycles as they are, and with one need switched off; {found['size']} x {found['size']} pixels, "
        f"{found['samples']} samples, references of {found['reference']}. Time is the CPU time of a sample over that without the need, the median of {TURNS} turns; "
        "a busy machine moves it by a fifth. *Noise* is the relMSE of "
        f"{found['spp']} uniform samples, each picture judged by its own reference. *Left out* is the relMSE of the converged picture without the need, judged by the reference "
        "with it, less the noise of the references, which is the last column (two references with other random numbers): no number of samples brings it down.",
        table(["scene", "a sample needs", "time of a sample", "noise without it", "noise with it", "left out", "two references"], rows),
        "A need asks for no bytes: the point on the lens, the moment and the way through the medium are in the radiance of the sample. Only who studies them records them "
        "as layers (below)."]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--folder", default=ROOT / "build/needs_left_out", type=Path)
    parser.add_argument("--write-only", action="store_true")
    parser.add_argument("-o", "--output", default=ROOT / "docs/scene_needs.md", type=Path)
    arguments = parser.parse_args()
    if not arguments.write_only:
        measure(arguments.program.resolve(), arguments.folder)
    write_whole(arguments.output, with_part(arguments.output.read_text(encoding="utf-8"), TITLE, part()))


if __name__ == "__main__":
    main()
