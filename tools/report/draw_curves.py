#!/usr/bin/env python3
"""Draws curves.csv, error over budget and over time with 95 % intervals, as PDF, SVG and PNG.

usage: curves.py [curves.csv] [-o NAME] [--column 1|2] [--font latex]
Needs matplotlib and, beside it, figure_text.py and metric_names.py; edit it for your paper.
"""

import argparse
import csv
import math
from collections import defaultdict
from pathlib import Path

from matplotlib import pyplot
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from tools.report.figure_text import WIDTHS, extent, literal, save, style, tick_text, whole
from tools.report.metric_names import metric_name

# Okabe and Ito's colours; marker and dash separate lines without colour.
COLOURS = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f"]
MARKERS = ["o", "s", "D", "^", "v", "P", "X", "*"]
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (3, 1)), (0, (1, 1)), (0, (8, 2))]
MOST_PANELS = 9  # of a page
GAP = 0.06  # inches, between labels


def read(path):
    """{scene: {method: [(spp, mean, low, high, seconds)]}}, and the metric; the rows that are marked as drawn, in the
    order of the marks. A ' before a text keeps spreadsheets from computing it."""
    curves, metric = defaultdict(lambda: defaultdict(list)), ""
    with open(path, newline="", encoding="utf-8") as file:
        for row in sorted(csv.DictReader(file), key=lambda row: int(row["drawn"])):
            scene, method, metric = (row[key][row[key][:1] == "'":] for key in ("scene", "method", "metric"))
            if row["drawn"] != "0" and row["mean"] and float(row["mean"]) > 0:
                mean = float(row["mean"])
                low, high = (float(row[key]) if row[key] else math.nan for key in ("low", "high"))  # no bar
                seconds = float(row["seconds"]) if row["seconds"] else math.nan
                # The ends of an interval without width may lie beside its mean by a rounding.
                curves[scene][method].append((float(row["spp"]), mean, min(low, mean), max(high, mean), seconds))
    return curves, metric


def ticks_between(low, high, most):
    """At most that many values on a logarithmic axis, and two where there can be."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    for step in ((1, 2, 5), (1, 3), (1,)):
        values = [m * 10.0 ** k for k in range(first, last + 1) for m in step]
        inside = [v for v in values if low <= v <= high]
        if 2 <= len(inside) <= most:
            return inside
    if len(inside) > most:
        return inside[::-(-len(inside) // most)]
    return [v for v in MaxNLocator(most - 1).tick_values(low, high) if low <= v <= high]


def budget_ticks(figure, budgets, width):
    """Those whose labels do not touch, the first and the last among them."""
    left, right = math.log(budgets[0]), math.log(budgets[-1])
    at = {b: 0.9 * width * (math.log(b) - left) / ((right - left) or 1.0) for b in budgets}
    reach = {b: extent(figure, f"{b:g}", 8)[0] / 2 + GAP / 2 for b in budgets}
    kept = [budgets[0], budgets[-1]] if len(budgets) > 1 else budgets[:1]
    for b in budgets[1:-1]:
        if all(abs(at[b] - at[k]) > reach[b] + reach[k] for k in kept):
            kept.append(b)
    return sorted(kept)


def panel(axes, methods, colour_of, width, over_time):
    """`methods`: [(spp, mean, low, high, seconds)] of each."""
    figure = axes.figure
    budgets = sorted({point[0] for points in methods.values() for point in points})
    spread = 0.06 if len(budgets) > 1 else 0.3
    lows, highs, places = [], [], []
    for place, (method, points) in enumerate(methods.items()):
        share = place / (len(methods) - 1) - 0.5 if len(methods) > 1 else 0.0
        aside = 1 if over_time else 1 + spread * share  # bars at one budget stand beside each other
        points = sorted(points)
        xs = [point[4] if over_time else point[0] * aside for point in points]
        means = [point[1] for point in points]
        # One that reaches zero has no end on a logarithmic axis: it leaves the panel, and does not stretch it.
        bars = [[m - max(p[2], 0.0) for m, p in zip(means, points)], [p[3] - m for m, p in zip(means, points)]]
        places += xs
        lows += [p[2] if p[2] > 0 else m for m, p in zip(means, points)]
        highs += [m + bar if bar == bar else m for m, bar in zip(means, bars[1])]
        turn, i = divmod(colour_of[method], len(COLOURS))  # the ninth has the colour of the first with another marker
        axes.errorbar(xs, means, yerr=bars if any(bar == bar for bar in bars[0]) else None, color=COLOURS[i], marker=MARKERS[(i + turn) % 8],
                      linestyle=DASHES[(i + 3 * turn) % 8], capsize=1.8, elinewidth=0.7, label=method)
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = min(lows), max(highs)
    margin = max(1.03, (high / low) ** 0.05)
    axes.set_ylim(low / margin, high * margin)
    if len(budgets) == 1 and max(places) < 2 * min(places):
        axes.set_xlim(min(places) / 2, max(places) * 2)
    x_ticks = ticks_between(*axes.get_xlim(), 4) if over_time else budget_ticks(figure, budgets, width)
    for axis, ticks in ((axes.xaxis, x_ticks), (axes.yaxis, ticks_between(*axes.get_ylim(), 6))):
        axis.set_major_locator(FixedLocator(ticks))
        axis.set_major_formatter(FuncFormatter(tick_text))
        axis.set_minor_locator(NullLocator())
    axes.grid(True, color="#dddddd", linewidth=0.4)


def legend(figure, handles, width):
    """Below, in as many columns as the page has room for; its height in inches."""
    names = list(handles)
    for columns in range(min(len(names), 4), 0, -1):
        room = width / columns - 0.5
        labels = [whole(figure, name, room, 7.5) if columns == 1 else literal(name) for name in names]
        made = figure.legend(handles.values(), labels, loc="lower center", ncol=columns, frameon=False, borderpad=0.2,
                             borderaxespad=0.1, handlelength=2.6, columnspacing=1.4)
        box = made.get_window_extent(figure.canvas.get_renderer())
        if columns == 1 or box.width <= 0.97 * width * figure.dpi:
            return box.height / figure.dpi
        made.remove()
    return 0.0


def page(curves, metric, colour_of, output, column, over_time, **kinds):
    width = WIDTHS[column]
    across = min(len(curves), 3 if column == 2 and len(curves) != 4 else 1 if len(curves) < 4 else 2)
    down = -(-len(curves) // across)
    figure, grid = pyplot.subplots(down, across, figsize=(width, 2.0 * down), squeeze=False)
    room = width / across - 0.75
    for axes in grid.flat[len(curves):]:
        axes.set_visible(False)
    titles = 0.0
    for axes, (scene, methods) in zip(grid.flat, curves.items()):
        panel(axes, methods, colour_of, room, over_time)
        title = whole(figure, scene, room, 8)
        titles = max(titles, 0.12 * title.count("\n"))
        axes.set_title(title)
        axes.set_xlabel("time in seconds" if over_time else "samples per pixel")
    for axes in grid[:, 0]:
        axes.set_ylabel(whole(figure, metric_name(metric), 1.4, 8))
    handles = {}
    for axes in grid.flat[:len(curves)]:
        handles.update({label: handle for handle, label in zip(*axes.get_legend_handles_labels())})
    handles = {name: handles[name] for name in colour_of if name in handles}
    below = legend(figure, handles, width)
    height = (1.95 + titles) * down + below + 0.05
    figure.set_size_inches(width, height)
    figure.tight_layout(pad=0.3, h_pad=0.8, w_pad=0.8, rect=(0, (below + 0.03) / height, 1, 1))
    return save(figure, output, **kinds)


def draw(path, place, column=0, font=""):
    """Files written; `place` gives the path of a page from what comes after its name."""
    return draw_pages(*read(path), place, column, font)


def draw_pages(curves, metric, place, column=0, font="", times=(False, True), **kinds):
    """As draw(), of what read() gives. `times`: over budget, over time, or both;
    kinds=: as save()."""
    column = column or (1 if len(curves) == 1 else 2)
    colour_of = {}
    for methods in curves.values():
        for method in methods:
            colour_of.setdefault(method, len(colour_of))
    written = []
    with pyplot.rc_context(style(font)):
        for over_time in times:
            shown = {scene: {m: [p for p in points if not over_time or p[4] > 0] for m, points in methods.items()}
                     for scene, methods in curves.items()}
            shown = {scene: {m: points for m, points in methods.items() if points} for scene, methods in shown.items()}
            shown = [(scene, methods) for scene, methods in shown.items() if methods]
            for start in range(0, len(shown), MOST_PANELS):
                name = ("_time" if over_time else "") + (f"-{start // MOST_PANELS + 1}" if start else "")
                written += page(dict(shown[start:start + MOST_PANELS]), metric, colour_of, place(name), column, over_time, **kinds)
    return written


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("source", nargs="?", default=Path(__file__).with_name("curves.csv"))
    parser.add_argument("-o", "--output", default="curves")
    parser.add_argument("--column", type=int, default=0, choices=(1, 2))
    parser.add_argument("--font", default="", help="latex, or latex:PACKAGE")
    asked = parser.parse_args()
    print(*draw(asked.source, lambda after: asked.output + after, asked.column, asked.font))
