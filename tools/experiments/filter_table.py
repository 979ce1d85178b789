"""Table of filters from results of `spool evaluate`: filter_table.py RESULTS... [--metric relmse_trimmed].

A line for each sampler and filter, a column for each budget: geometric mean over recordings of the mean over replicates,
divided by that of `--against` at the same budget; mean energy ratio; CPU seconds of the filter per megapixel, the median.
With --each a line for each recording instead, of the smallest and largest of which a goal may speak. With --intervals, behind each
figure, the library's 95 % interval of the geometric mean over other recordings of the kind.
"""
import argparse
import csv
import math
from collections import defaultdict
from pathlib import Path

from inference import mean_of


def read(folders):
    """{(sampler, filter, spp): {recording: [row, ...]}} of all rows that have figures."""
    cells = defaultdict(lambda: defaultdict(list))
    for folder in folders:
        with open(Path(folder) / "results.csv", encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                if not row["error"]:
                    cells[row["sampler"], row["filter"], float(row["spp"])][row["dump"]].append(row)
    return cells


def mean(rows, column):
    values = [float(row[column]) for row in rows]
    return sum(values) / len(values)


def ratios(of, to, metric):
    """Over the recordings that both have."""
    return {name: mean(of[name], metric) / mean(to[name], metric) for name in of if name in to}


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def interval(values):
    """(low, high) of the geometric mean, or None for fewer than two recordings."""
    return mean_of(values)[1:3] if len(values) > 1 else None


def figure(found, energies, intervals):
    if not found:
        return ""
    text = f"{geometric_mean(found):.3f}"
    bounds = interval(found) if intervals else None
    if bounds:
        text += f" ({bounds[0]:.2f}..{bounds[1]:.2f})"
    return f"{text} / {sum(energies) / len(energies):.3f}"


def cost(rows):
    """CPU seconds per megapixel."""
    values = sorted(float(row["cpu_filtering"]) / int(row["width"]) / int(row["height"]) * 1e6 for row in rows)
    return values[len(values) // 2]


def table(cells, metric, against, intervals=False):
    budgets = sorted({spp for _, _, spp in cells})
    lines = ["| sampler + filter | " + " | ".join(f"{spp:g} spp" for spp in budgets) + " | CPU-s/MP |",
             "|---" * (len(budgets) + 2) + "|"]
    for sampler, name in sorted({key[:2] for key in cells}):
        columns, rows = [], []
        for spp in budgets:
            of = cells[sampler, name, spp]
            found = list(ratios(of, cells[(*against, spp)], metric).values())
            energies = [mean(each, "energy_ratio") for each in of.values()]
            columns.append(figure(found, energies, intervals))
            rows += [row for each in of.values() for row in each]
        lines.append(f"| {sampler} + {name} | " + " | ".join(columns) + f" | {cost(rows):.1f} |")
    return "\n".join(lines)


def table_of_each(cells, metric, against):
    budgets = sorted({spp for _, _, spp in cells})
    recordings = sorted({name for of in cells.values() for name in of})
    lines = ["| sampler + filter | spp | " + " | ".join(recordings) + " |", "|---" * (len(recordings) + 2) + "|"]
    for sampler, name in sorted({key[:2] for key in cells}):
        for spp in budgets:
            of = cells[sampler, name, spp]
            found = ratios(of, cells[(*against, spp)], metric)
            columns = [f"{found[r]:.3f} / {mean(of[r], 'energy_ratio'):.3f}" if r in found else "" for r in recordings]
            lines.append(f"| {sampler} + {name} | {spp:g} | " + " | ".join(columns) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", help="folders of spool evaluate")
    parser.add_argument("--metric", default="relmse_trimmed")
    parser.add_argument("--against", default="uniform + box", help="SAMPLER + FILTER whose error is 1")
    parser.add_argument("--each", action="store_true", help="every recording by itself")
    parser.add_argument("--intervals", action="store_true", help="95 %% intervals over recordings")
    options = parser.parse_args()
    cells, against = read(options.results), tuple(options.against.split(" + ", 1))
    if options.each:
        print(table_of_each(cells, options.metric, against))
    else:
        print(table(cells, options.metric, against, options.intervals))


if __name__ == "__main__":
    main()
