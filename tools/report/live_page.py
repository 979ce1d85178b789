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
    found = [{"path": paths[Path(dump).name], "label": label} for dump, label in read_statistics(folder).labels().items()
             if Path(dump).name in paths and Path(paths[Path(dump).name]).is_file()]
    return {"recordings": found if order is not None else [],
            "seed": order if isinstance(order, int) else None}
