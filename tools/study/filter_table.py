"""Filters from results of `spool evaluate`, as CSV: filter_table.py RESULTS... [--metric relmse_trimmed], for docs/results/filters.

A row for each sampler and filter. For each budget the program's geometric mean over recordings (`overall` of statistics.json) over that of
`--against`, with which all folders share their recordings, and the mean energy ratio; CPU milliseconds of the filter.
With --each columns for each recording instead, without the time.
"""
import argparse
import json
from pathlib import Path

from tools.study import tables


def read(folders, each):
    """{(sampler, filter): {(recording or "", spp): {quantity: mean}}}"""
    cells = {}
    for folder in folders:
        statistics = json.loads((Path(folder) / "statistics.json").read_text(encoding="utf-8"))
        for entry in statistics["results" if each else "overall"]:
            place = (Path(entry["dump"]).stem if each else "", entry["spp"])
            means = {name: found[0] for name, found in entry.get("quantities", {}).items()}
            cells.setdefault((entry["sampler"], entry["filter"]), {})[place] = means
    return cells


def figure(found, base, metric):
    """The ratio of errors, and the energy."""
    return [f"{found[metric] / base[metric]:.3f}", f"{found['energy_ratio']:.3f}"] if metric in found and metric in base else ["", ""]


def table(cells, metric, against, each):
    places = sorted({place for of in cells.values() for place in of})
    header = ["sampler + filter", *(f"{name} {spp:g} spp {what}".strip() for name, spp in places for what in ("relmse", "energy"))]
    rows = []
    for method, of in sorted(cells.items()):
        columns = [value for place in places for value in figure(of.get(place, {}), cells[against].get(place, {}), metric)]
        cost = [] if each else [f"{1000 * max(found.get('cpu_filtering', 0) for found in of.values()):.1f}"]
        rows.append([" + ".join(method), *columns, *cost])
    return tables.as_csv(header + ([] if each else ["CPU ms"]), rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", help="folders of spool evaluate")
    parser.add_argument("--metric", default="relmse_trimmed")
    parser.add_argument("--against", default="uniform + box", help="SAMPLER + FILTER whose error is 1")
    parser.add_argument("--each", action="store_true", help="every recording by itself")
    options = parser.parse_args()
    cells = read(options.results, options.each)
    print(table(cells, options.metric, tuple(options.against.split(" + ", 1)), options.each), end="")


if __name__ == "__main__":
    main()
