"""Error over budget for every plan of several budgets, drawn when the site is built: plots.py FOLDER.

Writes FOLDER/curves/PLAN.svg and the pages curves.md and claims.md beside that folder from docs/results/experiments[_full]: a panel for each
recording, a line for each method that a claim names, with its 95 % interval, as statistics.json has them; and every claim with its verdict.
"""
import sys
from pathlib import Path

import matplotlib.pyplot as plt

from tools.study import pages, tables
from tools.study.plans import ROOT

plt.switch_backend("Agg")
COLOURS = ("#000000", "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")  # distinct for the colour-blind
MARKERS = "os^vDP*X"
COLUMNS = 4


def curves_of(statistics, metric="relmse"):
    """{recording: {method: [(budget, [mean, low, high])]}} of the methods that claims name."""
    named = {claim[k] for claim in statistics["claims"] for k in ("better", "than")}
    found = {}
    for entry in statistics["results"]:
        method, quantity = f"{entry['sampler']} + {entry['filter']}", entry["quantities"].get(metric, [])
        if method in named and len(quantity) == 3 and quantity[1] > 0:
            found.setdefault(tables.recording(entry["dump"]), {}).setdefault(method, []).append((entry["spp"], quantity))
    return found


def draw(curves, path):
    rows = -(-len(curves) // COLUMNS)
    figure, axes = plt.subplots(rows, COLUMNS, figsize=(3.2 * COLUMNS, 2.8 * rows), squeeze=False)
    methods = list(dict.fromkeys(m for of in curves.values() for m in of))
    for axis, (name, of) in zip(axes.flat, curves.items()):
        for method, points in of.items():
            i = methods.index(method)
            budgets, (means, lows, highs) = [p[0] for p in points], zip(*(p[1] for p in points))
            errors = [[m - a for m, a in zip(means, lows)], [b - m for m, b in zip(means, highs)]]
            axis.errorbar(budgets, means, errors, color=COLOURS[i % 8], marker=MARKERS[i // 8 % 8], markersize=3, linewidth=1, label=method)
        axis.set(title=name, xscale="log", yscale="log")
    for axis in list(axes.flat)[len(curves):]:
        axis.set_axis_off()
    handles = {label: handle for axis in axes.flat for handle, label in zip(*axis.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=2, fontsize=7)
    figure.subplots_adjust(wspace=0.3, hspace=0.35)
    figure.savefig(path, metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)


def main():
    folder = Path(sys.argv[1])
    (folder / "curves").mkdir(parents=True, exist_ok=True)
    blocks = ["# Curves of the experiments", "relMSE over samples per pixel with 95 % intervals, of the methods that the claims of a plan name."]
    for name, title in (("experiments", "64 x 64 pixels"), ("experiments_full", "Full size")):
        store = pages.Kept(ROOT / "docs/results" / name)
        blocks.append(f"## {title}")
        for plan in sorted(p.name.split(".")[0] for p in store.folder.glob("*.tar.xz")):
            statistics = store.json(plan, "statistics.json")
            curves = curves_of(statistics)
            if len({e["spp"] for e in statistics["results"]}) > 1 and curves:
                file = f"curves/{name}_{plan}.svg"
                draw(curves, folder / file)
                blocks.append(f"![relMSE over samples per pixel, plan {plan}]({file})")
    claims = ["# Claims of the experiments", "The verdict, and at how many places (recordings and budgets) a claim holds / is reversed / is undecided; after a "
              "minus those without a verdict. [R]: a re-implementation by description."]
    for name, title in (("experiments_full", "Full size"), ("experiments", "64 x 64 pixels")):
        claims += [f"## {title}", *pages.chapter_claims(pages.Kept(ROOT / "docs/results" / name), name == "experiments_full")]
    (folder / "claims.md").write_text("\n\n".join(claims) + "\n", encoding="utf-8")
    (folder / "curves").with_suffix(".md").write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
