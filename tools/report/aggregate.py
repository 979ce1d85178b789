"""The combinations of a report: what statistics.json says of each, with its rows of results.csv.

A combination is a scene, a budget, a sampler and a filter.
"""

import re
from collections import defaultdict
from html import escape
from pathlib import PurePath

from tools.report.statistics_file import Interval, interval_of

MARK = " [R]"  # of methods that are no originals, wherever the page names them
RATIO_METRICS = ("mse", "relmse")
TIMES = ("seconds_total", "seconds_sampling", "seconds_filtering", "cpu_sampling", "cpu_filtering",
         "seconds_reading", "seconds_judging", "seconds_writing", "peak_memory_mb")


class Combination:
    def __init__(self, entry):
        self.dump, self.spp = entry["dump"], entry["spp"]
        self.sampler, self.filter = entry["sampler"], entry["filter"]
        self.replicates = entry["replicates"] + entry["failed"]
        self.one_image = entry["one_image"]
        self.quantities = {name: interval_of(v) for name, v in entry.get("quantities", {}).items()}
        self.ranks = {}  # metric: its entry in the ranking of its condition
        self.rows, self.failures = [], []  # rows without error only; messages
        self.guards = defaultdict(float)

    @property
    def key(self):
        return self.dump, self.spp, self.sampler, self.filter

    @property
    def method(self):
        return f"{self.sampler} + {self.filter}"

    def quantity(self, name):
        return self.quantities.get(name, Interval())


def aggregate(table, statistics):
    """Combinations in the order of the statistics."""
    combinations = {}
    for entry in statistics.results:
        combination = Combination(entry)
        combinations[combination.key] = combination
    for condition in statistics.conditions:
        for entry in condition["ranking"]:
            key = (condition["dump"], condition["spp"], entry["sampler"], entry["filter"])
            combination = combinations[key]
            combination.ranks[condition["metric"]] = entry
            if condition["metric"] in RATIO_METRICS and entry.get("ratio"):
                combination.quantities[condition["metric"] + "_ratio"] = interval_of(entry["ratio"])
    scene_of = statistics.scene_of()
    for row in table.rows:
        key = (scene_of.get(PurePath(row["dump"]).name, row["dump"]), row["spp"], row["sampler"], row["filter"])
        if key in combinations:
            _add_row(combinations[key], row)
    return list(combinations.values())


def _add_row(combination, row):
    if row.get("error"):
        combination.failures.append(row["error"])
    else:
        combination.rows.append(row)
    for name, count in guard_counts(row.get("guards", "")):
        combination.guards[name] += count


def guard_counts(text):
    """"name=count name=count" as written in the column guards."""
    for part in text.split():
        name, _, count = part.rpartition("=")
        if name and count.isdigit():
            yield name, int(count)


class Described:
    """Methods that the manifest calls re-implementations by description."""

    def __init__(self, manifest):
        plan = manifest.get("plan")
        plan = plan if isinstance(plan, dict) else {}
        described = {kind: [m for m in plan.get(kind) or [] if isinstance(m, dict) and m.get("by_description")]
                     for kind in ("samplers", "filters")}
        self._names = {kind: {str(m.get("name")) for m in methods} for kind, methods in described.items()}
        self._labels = {kind: {str(m.get("label")) for m in methods} for kind, methods in described.items()}

    def mark(self, combinations, statistics):
        """Their names, once nothing looks for files of combinations any more."""
        for c in combinations:
            c.sampler, c.filter = self._marked(c.sampler, c.filter)
        for entry in statistics.methods():
            entry["sampler"], entry["filter"] = self._marked(entry["sampler"], entry["filter"])
        if statistics.baseline:
            sampler, _, filter_ = statistics.baseline.partition(" + ")
            statistics.baseline = " + ".join(self._marked(sampler, filter_))

    def note(self):
        """What the mark means, beside every table that names such methods."""
        names = sorted(self._names["samplers"] | self._names["filters"])
        if not names:
            return ""
        return f"<p>[R] {escape(', '.join(names))}: re-implementation by description, not from the primary text.</p>"

    def _marked(self, *labels):
        """Of a sampler and a filter."""
        return [label + MARK if re.split(r"[:{ ]", label, maxsplit=1)[0] in self._names[kind] or label in self._labels[kind] else label
                for label, kind in zip(labels, ("samplers", "filters"))]
