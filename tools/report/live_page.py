"""The page of `spool view`, whose pictures the program computes on request.

usage: run.py live_page [--title TEXT]    prints the page
       run.py live_page --facts DIR       prints what a folder of results says of its recordings and methods, as JSON
"""

import argparse
import json
from pathlib import Path

from tools.report.failure import guarded


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="spool view", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--title", default="")
    parser.add_argument("--facts", type=Path)
    options = parser.parse_args(arguments)
    return guarded(lambda: json.dumps(facts(options.facts)) if options.facts else page(options.title))


def page(title):
    from tools.report.page import build_page, licences_html

    # Filled by live.js with what the program says.
    data = {"dumps": [], "samplers": [], "filters": [], "metric": "relmse", "metrics": [], "quantities": [], "combinations": [],
            "overall": [], "budget": None, "baseline": "uniform + box", "own": [], "conditions": [], "pixels": [], "live": True,
            "pictures": {"scenes": [], "images": [], "sets": []}}
    sections = [("images", "", '<div id="live-area"></div>'), ("run", "", licences_html())]
    return build_page(f"Spool: {title}", sections, data, [], served=True)


def facts(folder):
    from tools.report.pixel_data import recording_paths, replay_order
    from tools.report.results_table import read_results
    from tools.report.statistics_file import read_statistics
    from tools.report.vocabulary import read_manifest

    read_results(folder / "results.csv")  # the error where it is no folder of results
    manifest = read_manifest(folder)
    order, paths = replay_order(manifest), recording_paths(manifest)
    found, left_out = [], []
    for dump, label in read_statistics(folder).labels().items():
        path = paths.get(Path(dump).name)
        if order is None:
            left_out.append(f"{label} ({_why_without_order(manifest.get('plan'))})")
        elif path is None or not Path(path).is_file():
            left_out.append(f"{label} (no file {path or dump})")
        else:
            found.append({"path": path, "label": label})
    return {"recordings": found, "seed": order if isinstance(order, int) else None, "left_out": left_out}


def _why_without_order(plan):
    plan = plan if isinstance(plan, dict) else {}
    return ("in pieces of pixels" if plan.get("pieces_per_side", 1) != 1 else "by split decisions" if plan.get("decision_split")
            else "its order of samples is not known")
