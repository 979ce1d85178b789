"""Figures and tables for a paper from the folder that `spool evaluate` wrote.

usage: figure.py DIR -o FOLDER [--metric relmse] [--spp 8] [--recording NAME]... [--method "sampler + filter"]... [--force]
Needs Python 3.9, numpy and matplotlib. Errors are one line on stderr; exit codes are those of spool.
"""

import argparse
import shutil
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

from failure import NO_NUMPY, USAGE, Failure, guarded  # noqa: E402

MOST_METHODS = 5


def main(arguments=None):
    return guarded(lambda: _main(arguments))


def _main(arguments):
    options = parse(arguments)
    try:
        import matplotlib  # noqa: F401
        import numpy  # noqa: F401
    except ImportError as error:
        raise Failure("spool figure needs numpy and matplotlib: apt-get install python3-matplotlib, or pip install "
                      "matplotlib into the Python that SPOOL_PYTHON names", NO_NUMPY) from error
    return make_figures(options)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="spool figure", description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path, help="what spool evaluate -o DIR wrote")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the figures")
    parser.add_argument("--metric", default="")
    parser.add_argument("--spp", type=float, default=0.0, help="budget of the comparison (the middle one)")
    parser.add_argument("--recording", action="append", default=[], help="its comparison only; may be repeated")
    parser.add_argument("--method", action="append", default=[], help="'sampler + filter', in this order")
    parser.add_argument("--force", action="store_true", help="replace figures")
    return parser.parse_args(arguments)


def make_figures(options):
    from aggregate import aggregate
    from described import Described
    from draw_curves import draw
    from figure_folder import FigureFolder
    from figure_tables import curves_csv, latex_table, markdown_table
    from headline_data import headline_budget
    from file_names import dump_names, file_name_of, numbered
    from result_images import find_images
    from results_table import choose_metric, read_results
    from statistics_file import read_statistics
    from vocabulary import read_manifest

    table = read_results(options.folder / "results.csv")
    metric = choose_metric(options.metric, table)
    statistics = read_statistics(options.folder)
    if metric not in statistics.metrics():
        raise Failure(f"--metric: methods are ranked by {', '.join(statistics.metrics())}, not by {metric}", USAGE)
    combinations = aggregate(table, statistics)
    labels = dump_names(dict.fromkeys(c.dump for c in combinations))
    labels.update({s["dump"]: s["group"] for s in statistics.scenes if s["group"]})
    found = find_images(options.folder, combinations)
    described = Described(read_manifest(options.folder))
    described.mark(combinations)
    described.mark_statistics(statistics)
    budget = options.spp or headline_budget(statistics, metric)
    conditions = [c for c in statistics.of_metric(metric) if c["spp"] == budget]
    if not conditions:
        raise Failure(f"--spp: no results at {budget:g} samples per pixel", USAGE)
    for name in options.recording:
        if name not in labels.values():
            raise Failure(f"--recording: no {name}; there are {', '.join(labels.values())}", USAGE)
    chosen = choose_methods(options.method, conditions[0])
    images = {combinations[entry.combination].key: entry.paths for entry in found}
    names = numbered({dump: f"comparison_{file_name_of(label)}" for dump, label in labels.items()})
    compared = 0
    with FigureFolder(options.output, options.force) as folder:
        folder.text("table.tex", latex_table(statistics, metric, labels))
        folder.text("table.md", markdown_table(statistics, metric, labels))
        curves = folder.text("curves.csv", curves_csv(statistics, metric, labels, chosen))
        shutil.copyfile(Path(__file__).with_name("draw_curves.py"), folder.file("curves.py"))
        draw(curves, folder.pictures("curves"))
        for condition in conditions:
            if options.recording and labels[condition["dump"]] not in options.recording:
                continue
            compared += compare(condition, chosen, images, folder, names[condition["dump"]])
    return (f"{options.output}: {compared} comparison{'' if compared == 1 else 's'}, curves and tables of {metric}"
            + ("" if compared else "; no pictures in the folder, so no comparison"))


def choose_methods(wanted, condition):
    """uniform + box and the first of the ranking, where nothing is asked for."""
    from statistics_file import BASELINE
    from summary import name_of
    names = [name_of(entry) for entry in condition["ranking"]]
    if wanted:
        for name in wanted:
            if name not in names:
                raise Failure(f"--method: no '{name}' at this budget; there are {'; '.join(names[:12])}", USAGE)
        return list(dict.fromkeys(wanted))
    baseline = [name for name in names if name == BASELINE]
    best = [name for name in names if name not in baseline][:MOST_METHODS - 1 - len(baseline)]
    return baseline + best[::-1]  # the best stands beside the reference


def compare(condition, chosen, images, folder, name):
    """Whether there were pictures to compare."""
    from figure_comparison import draw_comparison
    from headline_data import best_is_alone
    from number_text import interval_text
    from result_images import exposure_and_mean
    from exr_image import read_exr, rgb
    from statistics_file import interval_of
    from summary import name_of

    entries = {name_of(entry): entry for entry in condition["ranking"]}
    alone = best_is_alone(condition["ranking"])
    panels = []
    for method in chosen:
        entry = entries.get(method)
        paths = images.get((condition["dump"], condition["spp"], *(entry[k] for k in ("sampler", "filter")))) if entry else None
        if not paths:
            continue
        lines = [f"{condition['metric']} {interval_text(interval_of(entry['value'][:1]), 3)}" + (f" ({entry['letters']})" if entry["letters"] else "")]
        if len(entry["value"]) == 3:
            lines.append("[{:.3g}, {:.3g}]".format(*entry["value"][1:]))
        panels.append((method, lines, alone and entry is condition["ranking"][0], paths))
    if len(panels) < 2:
        return 0
    reference = panels[0][3].get("reference")
    guide = rgb(read_exr(reference or panels[-1][3]["estimate"]))
    draw_comparison(panels, reference, exposure_and_mean(guide)[0], folder.pictures(name))
    return 1


if __name__ == "__main__":
    sys.exit(main())
