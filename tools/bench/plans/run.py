"""What a plan on small pictures costs: tools/dev.sh bench plans [--turns N] [--print].

The whole of tools/plans/quick.toml, CPU and wall time, with its pictures and without; the least of some turns.
Writes a section of docs/speed.md, unless it shall only print.
"""
import argparse
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from tools.bench.speed_page import replace_section

ROOT = Path(__file__).resolve().parents[3]

PLAN = ROOT / "tools" / "plans" / "quick.toml"
CPU, WALL, OF = 8.0, 7.0, 540                   # targets, on two processors, for so many results
WAYS = {"as it is": [], "without pictures": ["--no-pictures"]}


def run(command):
    began = time.monotonic()
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL)
    _, code, used = os.wait4(process.pid, 0)
    if code != 0:
        sys.exit(f"plans: {' '.join(map(str, command))}: exit code {os.waitstatus_to_exitcode(code)}")
    return used.ru_utime + used.ru_stime, time.monotonic() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--print", action="store_true", help="leave docs/speed.md alone")
    options = parser.parse_args()
    folder = options.build.resolve() / "plans"
    found, results = {}, 0
    for _ in range(options.turns):
        for way, arguments in WAYS.items():
            shutil.rmtree(folder, ignore_errors=True)
            cpu, wall = run([options.build.resolve() / "spool", "evaluate", PLAN, "-q", *arguments, "-o", folder])
            print(f"{way}: {cpu:.2f} CPU-s, {wall:.2f} s", file=sys.stderr, flush=True)
            found[way] = tuple(map(min, found.get(way, (cpu, wall)), (cpu, wall)))
            results = len((folder / "results.jsonl").read_text(encoding="utf-8").splitlines())
    shutil.rmtree(folder)
    bold = lambda value, limit: f"{value:.1f}" if value <= limit else f"**{value:.1f}**"
    rows = [["`spool evaluate tools/plans/quick.toml`", "CPU-s", "wall, s"]] + [
        [way, bold(cpu, CPU * results / OF), bold(wall, WALL * results / OF)] for way, (cpu, wall) in found.items()]
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    lines.insert(1, "|---|---|---|")
    text = "\n\n".join([
        "## A plan on small pictures",
        f"`tools/dev.sh bench plans`: {results} results of 64x64 pixels, {os.cpu_count()} processors, the least of {options.turns} turn{'s' if options.turns > 1 else ''}. "
        f"Targets: {CPU:g} CPU-s and {WALL:g} s for {OF} results. Results of small pictures are made beside each other "
        "([decision](decisions.md#0083-results-of-small-pictures-are-made-beside-each-other)).", "\n".join(lines)])
    print(text)
    if not options.print:
        replace_section("plans", text)


if __name__ == "__main__":
    main()
