"""The combinations of a report: what statistics.json says of each, with its rows of results.csv.

A combination is a scene, a budget, a sampler and a filter.
"""

from collections import defaultdict
from pathlib import PurePath

from tools.report.statistics_file import Interval, interval_of

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
