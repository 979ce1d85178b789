"""statistics.json of `spool evaluate`: every mean, interval and verdict of a report is read from it.

Nothing here or elsewhere in the report computes one.
"""

import math
import re
from pathlib import PurePath
from typing import NamedTuple

from tools.report.failure import Failure
from tools.report.file_names import numbered
from tools.report.metric_names import BIASED, metric_name
from tools.report.number_text import count_text
from tools.report.results_table import bracketed_threads
from tools.report.vocabulary import read_json

NAN = float("nan")
VERSION = 1
BASELINE = "uniform + box"  # where a plan names no other
MOST_LETTERS = 10  # of one method; more are not read, and make tables too wide
MOST_GROUPS = 26  # beyond z, a letter has a number behind it
UNLETTERED = "Where methods are in too many groups to letter, no letters are shown; statistics.json has them."


class Interval(NamedTuple):
    mean: float = NAN
    low: float = NAN
    high: float = NAN


def interval_of(numbers):
    """Of [mean, low, high], [mean] or nothing."""
    numbers = [NAN if n is None else float(n) for n in numbers or []]
    return Interval(*numbers) if len(numbers) in (1, 3) else Interval()


def best_is_alone(condition):
    """Whether the first of a ranking may be printed as the best: the file separates it from every other that is compared,
    none that is not has a better mean, and images were not judged by their own samples."""
    def cost(entry):
        mean = interval_of(entry["value"]).mean
        return abs(math.log(mean) if mean > 0 else mean - 1) if condition["metric"] == "energy_ratio" else mean
    first, *others = condition["ranking"]
    compared = [entry for entry in others if entry["compared"]]
    return (bool(compared) and first["compared"] and not condition.get("biased") and all(e.get("against_best") == "worse" for e in compared)
            and not any(cost(e) < cost(first) for e in others if not e["compared"]))


def hide_crowded_letters(ranking):
    """Whether there were too many to show."""
    groups = [re.findall(r"[a-z]\d*", entry["letters"]) for entry in ranking]
    crowded = max(map(len, groups), default=0) > MOST_LETTERS or len(set().union(*groups)) > MOST_GROUPS
    for entry in ranking if crowded else ():
        entry["letters"] = ""
    return crowded


JUDGES = {"independent": "an independent reference", "holdout": "samples held out", "holdout_pair": "samples held out in two halves",
          "leave_selected_out": "the samples that were not taken", "crossfit": "the other half of the samples", "pool": "all samples"}


class Statistics:
    def __init__(self, data):
        self.rules = data.get("rules", {})
        self.claims = data.get("claims", [])
        self.scenes = data["scenes"]
        self.results = data["results"]
        self.conditions = data["conditions"]
        self.curves = data["curves"]
        self.overall = data["overall"]
        compared = any("against_baseline" in entry for c in self.conditions for entry in c["ranking"])
        self.baseline = data.get("baseline", BASELINE) if compared else ""  # none of its results: nothing is relative to it
        self.biased = any(c.get("biased") for c in self.conditions)
        self._name_threads()
        self.unlettered = {c["metric"] for c in self.conditions if hide_crowded_letters(c["ranking"])}

    def letters_note(self, metric):
        """Empty where all letters are shown."""
        return UNLETTERED if metric in self.unlettered else ""

    def scene_of(self):
        """{file name of a recording: the recording that its scene is named by}; no two have one file name."""
        return {PurePath(recording).name: scene["dump"] for scene in self.scenes for recording in scene["recordings"]}

    def recordings(self):
        """All of them, scene by scene."""
        return [recording for scene in self.scenes for recording in scene["recordings"]]

    def labels(self):
        """{recording that a scene is named by: what people read}."""
        files = numbered({scene["dump"]: PurePath(scene["dump"]).stem for scene in self.scenes})
        return {scene["dump"]: scene["group"] or files[scene["dump"]] for scene in self.scenes}

    def metrics(self):
        """Those that methods are ranked by."""
        return list(dict.fromkeys(c["metric"] for c in self.conditions))

    def metric_text(self, metric):
        """Its name, marked where nothing may be concluded from it."""
        return metric_name(metric + BIASED * self.biased)

    def judged_text(self):
        """By what reference; of one that is biased, what spool evaluate warns of."""
        found = sorted({entry["reference"].removesuffix(BIASED) for entry in self.results} - {""})
        kinds = ", ".join(JUDGES.get(kind, kind) for kind in found)
        return f"Judged by {kinds}." + (" BIASED: errors are too small, and differently for each method." if self.biased else "")

    def failed_text(self):
        """Empty where none did."""
        failed = sum(entry["failed"] for entry in self.results)
        return f" {count_text(failed, 'result')} failed and {'is' if failed == 1 else 'are'} left out." if failed else ""

    def warning(self):
        """What ends a line on the terminal; empty where nothing is biased."""
        return f". {self.judged_text()}" if self.biased else ""

    def of_metric(self, metric):
        return [c for c in self.conditions if c["metric"] == metric]

    def largest_budget(self, metric):
        """What is shown first."""
        return max((c["spp"] for c in self.of_metric(metric)), default=0.0)

    def methods(self):
        """Every entry that names a sampler and a filter."""
        yield from self.results
        yield from (entry for condition in self.conditions for entry in condition["ranking"])
        yield from self.curves
        yield from self.overall

    def _name_threads(self):
        """As results_table does: where numbers of threads are swept over, they are part of the sampler's name."""
        if len({entry["threads"] for entry in self.results}) < 2:
            return
        for entries, threads in [*((c["ranking"], c["threads"]) for c in self.conditions),
                                 *(([e], e["threads"]) for e in (*self.results, *self.curves, *self.overall))]:
            for entry in entries:
                entry["sampler"] += bracketed_threads(threads)


def read_statistics(folder):
    path = folder / "statistics.json"
    again = f"run spool evaluate --statistics-only {folder} first"
    if not path.exists():
        raise Failure(f"{path}: is not there: {again}", 3)
    data = read_json(path)
    if not isinstance(data, dict) or data.get("version") != VERSION:
        raise Failure(f"{path}: of another version of spool: {again}")
    return Statistics(data)
