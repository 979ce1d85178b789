"""Table of filters from results of `spool evaluate`: filter_table.py RESULTS... [--metric relmse_trimmed].

A line for each sampler and filter, a column for each budget: the program's geometric mean over recordings (`overall` of statistics.json)
over that of `--against`, with which all folders share their recordings; its mean energy ratio; CPU milliseconds of the filter.
With --each a line for each recording instead, of the smallest and largest of which a goal may speak.
"""
import argparse
import json
from pathlib import Path


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
    if metric not in found or metric not in base:
        return ""
    return f"{found[metric] / base[metric]:.3f} / {found['energy_ratio']:.3f}"


def table(cells, metric, against, each):
    places = sorted({place for of in cells.values() for place in of})
    header = [f"{name} {spp:g} spp".strip() for name, spp in places] + ([] if each else ["CPU ms"])
    lines = ["| sampler + filter | " + " | ".join(header) + " |", "|---" * (len(header) + 1) + "|"]
    for method, of in sorted(cells.items()):
        columns = [figure(of.get(place, {}), cells[against].get(place, {}), metric) for place in places]
        cost = [] if each else [f"{1000 * max(found.get('cpu_filtering', 0) for found in of.values()):.1f}"]
        lines.append(f"| {' + '.join(method)} | " + " | ".join(columns + cost) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", help="folders of spool evaluate")
    parser.add_argument("--metric", default="relmse_trimmed")
    parser.add_argument("--against", default="uniform + box", help="SAMPLER + FILTER whose error is 1")
    parser.add_argument("--each", action="store_true", help="every recording by itself")
    options = parser.parse_args()
    cells = read(options.results, options.each)
    print(table(cells, options.metric, tuple(options.against.split(" + ", 1)), options.each))


if __name__ == "__main__":
    main()
