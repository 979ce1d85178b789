#!/usr/bin/env python3
"""Draws curves.csv (error over budget or time, with 95 % intervals) as PDF, SVG and PNG.

usage: curves.py [curves.csv] [-o NAME]     needs matplotlib; edit it for your paper
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator  # noqa: E402

# Okabe and Ito's colours; marker and dash tell lines apart without colour.
COLOURS = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f"]
MARKERS = ["o", "s", "D", "^", "v", "P", "X", "*"]
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (3, 1)), (0, (1, 1)), (0, (8, 2))]
STYLE = {"font.family": "serif", "font.size": 8, "pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "path",
         "svg.hashsalt": "spool", "axes.linewidth": 0.6, "lines.linewidth": 1.1, "lines.markersize": 4,
         "legend.fontsize": 7, "axes.titlesize": 8, "mathtext.fontset": "dejavuserif"}


def read(path):
    """{scene: {method: [(spp, mean, low, high)]}}, and the metric; the rows that are marked as drawn. A ' before a
    text keeps spreadsheets from computing it."""
    curves, metric = defaultdict(lambda: defaultdict(list)), ""
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            scene, method, metric = (row[key][row[key][:1] == "'":] for key in ("scene", "method", "metric"))
            if row["drawn"] == "1" and row["mean"] and float(row["mean"]) > 0:
                mean = float(row["mean"])
                low, high = (float(row[key]) if row[key] else mean for key in ("low", "high"))
                curves[scene][method].append((float(row["spp"]), mean, low, high))
    return curves, metric


def literal(text):
    """No text of the file is read as mathematics; no character of it is one that SVG cannot hold."""
    text = "".join(c if c.isprintable() else " " for c in text)
    return text.replace("\\", r"\\").replace("$", r"\$")


def panel(axes, methods, colour_of):
    count = max(len(methods), 2)
    for place, (method, points) in enumerate(methods.items()):
        aside = 1 + 0.06 * (place / (count - 1) - 0.5)  # bars at one budget stand beside each other
        xs, means, lows, highs = zip(*sorted(points))
        i = colour_of[method]
        bars = [[m - max(low, m * 1e-6) for m, low in zip(means, lows)], [high - m for m, high in zip(means, highs)]]
        axes.errorbar([x * aside for x in xs], means, yerr=bars, color=COLOURS[i % 8], marker=MARKERS[i % 8],
                      linestyle=DASHES[i % 8], capsize=1.8, elinewidth=0.7, label=literal(method))
    budgets = sorted({point[0] for points in methods.values() for point in points})
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(budgets)
    axes.set_xticklabels([f"{b:g}" for b in budgets])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(True, color="#dddddd", linewidth=0.4)


def draw(path, output):
    """Files written."""
    curves, metric = read(path)
    with pyplot.rc_context(STYLE):
        names = list(dict.fromkeys(method for methods in curves.values() for method in methods))
        colour_of = {name: i for i, name in enumerate(names)}
        across = min(3, max(1, len(curves)))
        down = -(-max(1, len(curves)) // across)
        legend_rows = -(-len(names) // 3)
        height = 2.1 * down + 0.17 * legend_rows + 0.2
        figure, grid = pyplot.subplots(down, across, figsize=(min(7.0, 3.3 * across), height), squeeze=False)
        for axes in grid.flat[len(curves):]:
            axes.set_visible(False)
        for axes, (scene, methods) in zip(grid.flat, curves.items()):
            panel(axes, methods, colour_of)
            axes.set_title(literal(scene))
            axes.set_xlabel("samples per pixel")
        for axes in grid[:, 0]:
            axes.set_ylabel(literal(metric))
        handles = {}
        for axes in grid.flat:
            handles.update({label: handle for handle, label in zip(*axes.get_legend_handles_labels())})
        figure.legend(handles.values(), handles.keys(), loc="lower center", ncol=3, frameon=False)
        figure.tight_layout(rect=(0, (0.17 * legend_rows + 0.1) / height, 1, 1))
        return save(figure, output)


def save(figure, output):
    """The figure as PDF, SVG and PNG, the same bytes each time."""
    undated = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {"Software": None}}
    written = []
    for kind, metadata in undated.items():
        written.append(Path(f"{output}.{kind}"))
        figure.savefig(written[-1], metadata=metadata, dpi=300)
    pyplot.close(figure)
    return written


if __name__ == "__main__":
    words = sys.argv[1:]
    name = words[words.index("-o") + 1] if "-o" in words else "curves"
    source = words[0] if words and words[0] != "-o" else Path(__file__).with_name("curves.csv")
    print(*draw(source, name))
