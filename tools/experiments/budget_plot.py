"""Error over budget, or speed over threads, as SVG: one panel per table, one line per method; readable on white and on black."""
import math
import re

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator  # noqa: E402

# First header of a table that is drawn: what is drawn over what.
DRAWN = {"at samples per pixel": ("error", "budget"), "with threads": ("speed", "threads")}
# Okabe and Ito's colours, told apart by colour-blind readers, and their markers for grey print.
STYLES = list(zip(["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#b0a000"], "osD^vP*"))
INK = "#7f7f7f"
PANELS, HIGHLIGHTED = 36, 7
# Methods of the paper's figures: they have their names, whatever their error.
FIRST = ("multiscale{filter=5-3}", "multiscale:paper{filter=5-3}", "multiscale + box", "multiscale:paper + box", "mitchell + box", "adaptive_wavelet + box", "greedy_error + box",
         "multiscale + directional{anisotropy=none}", "multiscale + directional", "multiscale:paper + directional:paper")
WIDTH_OF_NAMES = 6.2  # inches

plt.rcParams.update({
    "svg.hashsalt": "spool", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9, "text.color": INK,
    "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False,
    "axes.spines.right": False, "savefig.transparent": True})


def value(cell):
    """(value, low, high) of "0.12 [0.10, 0.15]"; None for what is no positive number."""
    match = re.match(r"([-+.\deE]+)(?: \[([-+.\deE]+), ([-+.\deE]+)\])?$", cell.strip("* "))
    if not match or float(match[1]) <= 0:
        return None
    return float(match[1]), float(match[2] or match[1]), float(match[3] or match[1])


def series_of(table):
    """{method: [(budget, value, low, high)]}, and the row that the others are ratios to, if there is one."""
    budgets = [float(text) for text in table.header[1:]]
    lines, base = {}, None
    for name, *row in table.rows:
        if name.startswith("*"):
            base = name.strip("*").split(",")[0]
            continue
        points = [(b, *v) for b, v in zip(budgets, map(value, row)) if v]
        if points:
            lines[name.replace("\\|", "|")] = points
    return lines, base


def named_of(panels):
    """The methods to name: those of the paper's figures, then the lowest by the mean logarithm at their largest budget."""
    scores = {}
    for lines, _ in panels:
        for name, points in lines.items():
            scores.setdefault(name, []).append(math.log(points[-1][1]))
    ranked = sorted(scores, key=lambda name: (name.replace(" [R]", "") not in FIRST, sum(scores[name]) / len(scores[name])))
    return ranked[:HIGHLIGHTED]


def draw(axes, lines, base, named):
    for name, points in lines.items():
        x, y, low, high = zip(*points)
        if name in named:
            colour, marker = STYLES[named.index(name)]
            ends = [[max(v - a, 0.0) for v, a in zip(y, low)], [max(b - v, 0.0) for v, b in zip(y, high)]]
            axes.errorbar(x, y, ends, color=colour, marker=marker, ms=4, lw=1.4, capsize=2, label=name)
        else:
            axes.plot(x, y, color=INK, lw=0.6, alpha=0.5)
    if base:
        axes.axhline(1.0, color=INK, lw=0.8, ls=":")
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    ticks = sorted({point[0] for points in lines.values() for point in points})
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(lambda tick, _: f"{tick:g}")


def plot(path, tables):
    """Draws tables of error over budget; returns what was drawn in words, None for other tables."""
    tables = [table for table in tables if table.header[0] in DRAWN and len(table.header) > 2][:PANELS]
    panels = [series_of(table) for table in tables]
    if not any(lines for lines, _ in panels):
        return None
    what, over = DRAWN[tables[0].header[0]]
    axis = tables[0].header[0].partition(" ")[2]
    named = named_of(panels)
    columns = min(4 if len(panels) > 6 else 3, len(panels))  # four: MSE and relMSE of a recording stand side by side
    rows = -(-len(panels) // columns)
    width = max(2.7 * columns, WIDTH_OF_NAMES)
    beside = 2 if width > 1.5 * WIDTH_OF_NAMES else 1  # names in a row of the legend
    top = 0.2 * -(-len(named) // beside) + 0.35
    figure, grid = plt.subplots(rows, columns, figsize=(width, 2.3 * rows + top), squeeze=False)
    for axes, table, (lines, base) in zip(grid.flat, tables, panels):
        draw(axes, lines, base, named)
        axes.set_title(table.caption, fontsize=9)
    for axes in list(grid.flat)[len(panels):]:
        axes.set_visible(False)
    base = panels[0][1]
    handles = {label: handle for axes in grid.flat for handle, label in zip(*axes.get_legend_handles_labels())}
    shown = [name for name in named if name in handles]
    # Above the panels: below many of them nobody finds it.
    figure.legend([handles[name] for name in shown], shown, ncols=beside, loc="upper left", bbox_to_anchor=(0.01, 1.0), frameon=False, fontsize=8,
                  title=f"{what.capitalize()}{f' relative to {base}' if base else ''} over {axis}", title_fontsize=9, alignment="left")
    figure.tight_layout(rect=(0, 0, 1, 1 - top / (2.3 * rows + top)))
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    others = len({name for lines, _ in panels for name in lines}) - len(named)
    return f"{what} over {over}" + (f"; {len(named)} named, {others} others in grey" if others > 0 else "")
