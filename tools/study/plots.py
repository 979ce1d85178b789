"""Curves and long tables of every plan, made when the site is built: plots.py FOLDER.

Writes FOLDER/curves/PLAN.svg, FOLDER/cells/PLAN.csv and the pages curves.md and claims.md beside them from docs/results/experiments[_full]: of a
plan with several budgets a panel for each recording, a line for each method that a claim names, with its 95 % interval, as statistics.json has
them; every cell; every claim with its verdict.
"""
import math
import sys
from pathlib import Path

from matplotlib import pyplot

from tools.report.draw_curves import draw_pages
from tools.study import pages, tables
from tools.study.plans import ROOT

pyplot.switch_backend("Agg")
METRIC = "relmse"


def curves_of(statistics):
    """{recording: {method: [(spp, mean, low, high, no time)]}} of the methods that claims name."""
    named = {claim[k] for claim in statistics["claims"] for k in ("better", "than")}
    found = {}
    for entry in statistics["results"]:
        method, quantity = f"{entry['sampler']} + {entry['filter']}", entry["quantities"].get(METRIC, [])
        if method in named and len(quantity) == 3 and quantity[1] > 0:
            found.setdefault(tables.recording(entry["dump"]), {}).setdefault(method, []).append((entry["spp"], *quantity, math.nan))
    return found


def main():
    folder = Path(sys.argv[1])
    for name in ("curves", "cells"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    blocks = ["# Curves of the experiments", "relMSE over samples per pixel with 95 % intervals, of the methods that the claims of a plan name; every cell of each plan."]
    for name, title in (("experiments", "64 x 64 pixels"), ("experiments_full", "Full size")):
        store = pages.Kept(ROOT / "docs/results" / name)
        blocks.append(f"## {title}")
        plans = sorted(p.name.split(".")[0] for p in store.folder.glob("*.tar.xz"))
        blocks.append("Cells: " + ", ".join(f"[{plan}](cells/{name}_{plan}.csv)" for plan in plans))
        for plan in plans:
            statistics = store.json(plan, "statistics.json")
            (folder / "cells" / f"{name}_{plan}.csv").write_text(tables.results_csv(statistics), encoding="utf-8")
            curves = curves_of(statistics)
            if len({e["spp"] for e in statistics["results"]}) > 1 and curves:
                made = draw_pages(curves, METRIC, lambda after, at=f"{name}_{plan}": folder / "curves" / f"{at}{after}", times=(False,), kinds=("svg",))
                blocks += [f"![relMSE over samples per pixel, plan {plan}](curves/{file.name})" for file in made]
    claims = ["# Claims of the experiments", "The verdict, and at how many places (recordings and budgets) a claim holds / is reversed / is undecided; after a "
              "minus those without a verdict. [R]: a re-implementation by description."]
    for name, title in (("experiments_full", "Full size"), ("experiments", "64 x 64 pixels")):
        claims += [f"## {title}", *pages.chapter_claims(pages.Kept(ROOT / "docs/results" / name), name == "experiments_full")]
    (folder / "claims.md").write_text("\n\n".join(claims) + "\n", encoding="utf-8")
    (folder / "curves").with_suffix(".md").write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
