#!/usr/bin/env python3
"""What recording costs beside the renderer's own render of as many samples.

    python3 tools/bench/recorders/overhead.py cycles --scene table
    python3 tools/bench/recorders/overhead.py mitsuba --scene cornell-box

Whole processes are compared, start, loading, compression and verification included, once with radiance alone and
once with the default channels; recorder and plain render take turns, and the median of each counts. CPU time is that of all threads: on
a busy machine it is the figure to believe. disk: the most that the recording took of it, against the finished file.
"""
import argparse
import os
import statistics
import sys
import tempfile

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..", "..")))

from tools.bench.limited_run import run_or_end

HERE = os.path.dirname(os.path.abspath(__file__))
DUMPS = os.path.join(HERE, "..", "..", "..", "dumps")
BLENDER = ["-b", "--factory-startup", "--python-exit-code", "3", "-P"]


def commands(options, channels, folder):
    """(plain, recorder), both silent."""
    common = [options.scene, str(options.size), str(options.samples), channels]
    if options.renderer == "cycles":
        blender = os.environ.get("BLENDER", "blender")
        return ([blender, *BLENDER, os.path.join(HERE, "plain_cycles.py"), "--", *common],
                ["sh", os.path.join(DUMPS, "record.sh"), options.scene, "--size", str(options.size), "--samples", str(options.samples),
                 "--channels", channels, "--compress", "-o", folder + ".spool"])
    python = os.environ.get("SPOOL_MITSUBA_PYTHON") or os.path.expanduser("~/.cache/spool/mitsuba-venv/bin/python")
    return ([python, os.path.join(HERE, "plain_mitsuba.py"), *common],
            [python, os.path.join(DUMPS, "mitsuba", "record.py"), options.scene, "--size", str(options.size), "--samples",
             str(options.samples), "--channels", channels, "-o", folder + ".spool"])


def held(folder):
    """Bytes of the disk."""
    total = 0
    for path, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(os.path.join(path, name)).st_blocks * 512
            except OSError:
                pass                                        # it went meanwhile
    return total


def timed(command, folder):
    """(wall, CPU) seconds of one process and its children, and the most that the folder held against what it holds in the end."""
    found = run_or_end("overhead", command, watched=lambda: held(folder))
    return found["wall"], found["cpu"], found["watched"] / max(held(folder), 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("renderer", choices=("cycles", "mitsuba"))
    parser.add_argument("--scene", default="caustic", help="(caustic, which both renderers know)")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    many = options.size ** 2 * options.samples / 1e6
    print("%s, %s, %dx%d, %d samples a pixel (%.3g million), %d repeats" % (
        options.renderer, options.scene, options.size, options.size, options.samples, many, options.repeats))
    print("%-28s %10s %10s %12s %12s %10s %6s" % ("channels", "plain CPU", "recorder", "ratio of CPU", "ratio of wall", "M/s of CPU", "disk"))
    for channels in ("radiance", "radiance,albedo,normal,depth"):
        runs = {0: [], 1: []}
        for repeat in range(options.repeats):
            with tempfile.TemporaryDirectory() as folder:
                for which, command in enumerate(commands(options, channels, os.path.join(folder, "r%d" % repeat))):
                    runs[which].append(timed(command, folder))
        wall, cpu = ([statistics.median(run[k] for run in runs[which]) for which in (0, 1)] for k in (0, 1))
        print("%-28s %8.2f s %8.2f s %12.2f %12.2f %10.3g %6.2f" % (channels, *cpu, cpu[1] / cpu[0], wall[1] / wall[0], many / cpu[1],
                                                                    max(run[2] for run in runs[1])))


if __name__ == "__main__":
    main()
