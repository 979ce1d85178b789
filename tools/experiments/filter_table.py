"""Table of filters from results of `spool evaluate`: filter_table.py RESULTS... [--metric relmse_trimmed].

A line for each sampler and filter, a column for each budget: geometric mean over recordings of the mean over replicates,
divided by that of uniform + box at the same budget; mean energy ratio; CPU seconds of the filter per megapixel.
"""
import argparse
import csv
import math
from collections import defaultdict
from pathlib import Path


def read(folders):
    """{(sampler, filter, spp): {recording: [row, ...]}} of all rows that have figures."""
    cells = defaultdict(lambda: defaultdict(list))
    for folder in folders:
        with open(Path(folder) / "results.csv", encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                cells[row["sampler"], row["filter"], float(row["spp"])][row["dump"]].append(row)
    return cells


def mean(rows, column):
    values = [float(row[column]) for row in rows]
    return sum(values) / len(values)


def geometric_ratio(of, to, metric):
    """Over the recordings that both have."""
    logs = [math.log(mean(of[name], metric) / mean(to[name], metric)) for name in of if name in to]
    return math.exp(sum(logs) / len(logs))


def table(cells, metric, pixels):
    budgets = sorted({spp for _, _, spp in cells})
    lines = ["| sampler + filter | " + " | ".join(f"{spp:g} spp" for spp in budgets) + " | CPU-s/MP |",
             "|---" * (len(budgets) + 2) + "|"]
    for sampler, name in sorted({key[:2] for key in cells}):
        columns = []
        for spp in budgets:
            of = cells[sampler, name, spp]
            energies = [mean(rows, "energy_ratio") for rows in of.values()]
            columns.append(f"{geometric_ratio(of, cells['uniform', 'box', spp], metric):.3f} / "
                           f"{sum(energies) / len(energies):.3f}")
        cost = [float(row["cpu_filtering"]) for spp in budgets for rows in cells[sampler, name, spp].values() for row in rows]
        columns.append(f"{sorted(cost)[len(cost) // 2] / pixels * 1e6:.1f}")
        lines.append(f"| {sampler} + {name} | " + " | ".join(columns) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", help="folders of spool evaluate")
    parser.add_argument("--metric", default="relmse_trimmed")
    parser.add_argument("--pixels", type=int, default=64 * 64, help="of a recording, for the cost")
    options = parser.parse_args()
    print(table(read(options.results), options.metric, options.pixels))


if __name__ == "__main__":
    main()
