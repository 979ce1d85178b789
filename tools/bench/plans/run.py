"""What a plan on small pictures costs: tools/dev.sh bench plans [--turns N] [--print].

The whole of tools/plans/quick.toml, CPU and wall time, with its pictures and without; the least of some turns.
Writes a section of docs/speed.md, unless it shall only print.
"""
import os
import shutil
import sys

from tools.bench.limited_run import run_or_end
from tools.bench.speed_page import ROOT, parser_of, publish, turns_text
from tools.study.tables import markdown

PLAN = ROOT / "tools" / "plans" / "quick.toml"
CPU, WALL, OF = 8.0, 7.0, 540                   # targets, on two processors, for so many results
WAYS = {"as it is": [], "without pictures": ["--no-pictures"]}


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--turns", type=int, default=2)
    options = parser.parse_args()
    folder = options.build.resolve() / "plans"
    found, results = {}, 0
    for _ in range(options.turns):
        for way, arguments in WAYS.items():
            shutil.rmtree(folder, ignore_errors=True)
            taken = run_or_end("plans", [options.build.resolve() / "spool", "evaluate", PLAN, "-q", *arguments, "-o", folder])
            cpu, wall = taken["cpu"], taken["wall"]
            print(f"{way}: {cpu:.2f} CPU-s, {wall:.2f} s", file=sys.stderr, flush=True)
            found[way] = tuple(map(min, found.get(way, (cpu, wall)), (cpu, wall)))
            results = len((folder / "results.jsonl").read_text(encoding="utf-8").splitlines())
    shutil.rmtree(folder)
    bold = lambda value, limit: f"{value:.1f}" if value <= limit else f"**{value:.1f}**"
    rows = [[way, bold(cpu, CPU * results / OF), bold(wall, WALL * results / OF)] for way, (cpu, wall) in found.items()]
    text = "\n\n".join([
        "## A plan on small pictures",
        f"`tools/dev.sh bench plans`: {results} results of 64x64 pixels, {os.cpu_count()} processors, the least of {turns_text(options.turns)}. "
        f"Targets: {CPU:g} CPU-s and {WALL:g} s for {OF} results. Results of small pictures are made beside each other "
        "([decision](decisions.md#0083-results-of-small-pictures-are-made-beside-each-other)).",
        markdown(["`spool evaluate tools/plans/quick.toml`", "CPU-s", "wall, s"], rows)])
    publish("plans", text, options)


if __name__ == "__main__":
    main()
