"""Results summed up over replicates: mean and 95 % interval of every quantity of a combination.

A combination is a recording, a budget, a sampler and a filter. Replicate r of any two combinations
of one recording takes the same samples in the same order, so they are compared pair by pair.
"""

import math
from collections import defaultdict

from intervals import NAN, Interval, mean_interval, paired_ratio

BASELINE = ("uniform", "box")
RATIO_METRICS = ("mse", "relmse")
TIMES = ("seconds_total", "seconds_sampling", "seconds_filtering", "cpu_sampling", "cpu_filtering",
         "seconds_reading", "seconds_judging", "seconds_writing", "peak_memory_mb")
PIXEL_BOOTSTRAP_REACH = 1.959964  # standard errors either side: 95 % of a normal distribution


class Combination:
    def __init__(self, key):
        self.dump, self.spp, self.sampler, self.filter = key
        self.rows = {}  # replicate: row, results without error only
        self.failures = []  # messages
        self.replicates = 0
        self.alike = False  # the replicates repeat each other and say nothing about noise
        self.guards = defaultdict(float)
        self.quantities = {}  # name: Interval

    @property
    def method(self):
        return f"{self.sampler} + {self.filter}"

    def values(self, column):
        return [row.get(column, NAN) for row in self.rows.values()]

    def pairs(self, other, column):
        return [(row.get(column, NAN), other.rows[replicate].get(column, NAN))
                for replicate, row in self.rows.items() if replicate in other.rows]

    @property
    def independent_replicates(self):
        return min(len(self.rows), 1) if self.alike else len(self.rows)


def aggregate(table):
    """Combinations in the order of the file."""
    combinations = {}
    for row in table.rows:
        key = (row["dump"], row["spp"], row["sampler"], row["filter"])
        combination = combinations.setdefault(key, Combination(key))
        combination.replicates += 1
        if row.get("error"):
            combination.failures.append(row["error"])
        if math.isfinite(row.get(table.metrics[0], NAN) if table.metrics else NAN) or not row.get(
                "error"):
            combination.rows[row["replicate"]] = row
        for name, count in guard_counts(row.get("guards", "")):
            combination.guards[name] += count
    result = list(combinations.values())
    for combination in result:
        _add_quantities(combination, table.metrics)
    _add_ratios(result)
    return result


def guard_counts(text):
    """"name=count name=count" as written in the column guards."""
    for part in text.split():
        name, _, count = part.rpartition("=")
        if name and count.isdigit():
            yield name, int(count)


def _add_quantities(combination, metrics):
    rows = list(combination.rows.values())
    combination.alike = len(rows) > 1 and all(
        _same(row.get(name), rows[0].get(name)) for name in metrics for row in rows)
    for name in metrics:
        combination.quantities[name] = _metric_interval(combination, rows, name)
    for name in TIMES:
        combination.quantities[name] = mean_interval(combination.values(name))
    combination.quantities["samples_per_pixel"] = mean_interval(
        [row.get("samples_spent", NAN) / (row.get("width", NAN) * row.get("height", NAN) or NAN)
         for row in rows])
    combination.quantities["saturated_share"] = mean_interval(combination.values("saturated_share"))
    # Efficiency is left empty where the error is not resolved; a mean of the rest would flatter.
    efficiency = combination.values("efficiency")
    if efficiency and all(map(math.isfinite, efficiency)):
        combination.quantities["efficiency"] = mean_interval(efficiency)


def _same(a, b):
    return a == b or (a != a and b != b)


def _metric_interval(combination, rows, name):
    values = combination.values(name)
    if values and all(value == math.inf for value in values):
        return Interval(len(values), math.inf, math.inf, math.inf)
    if len(rows) == 1 or combination.alike:
        value, error = values[0], rows[0].get(name + "_se", NAN)
        reach = PIXEL_BOOTSTRAP_REACH * error
        return Interval(1, value, value - reach, value + reach)
    return mean_interval(values)


def baseline_of(combinations):
    """{(dump, spp): combination of uniform with box}, where that was run."""
    return {(c.dump, c.spp): c for c in combinations if (c.sampler, c.filter) == BASELINE}


def over_recordings(combinations, names):
    """One combination per method and budget that every recording has: geometric means.

    Intervals are those of the logarithms, the recordings taken as given: what another scene would
    give they do not say. A quantity that is not positive everywhere has no geometric mean.
    """
    dumps = {c.dump for c in combinations}
    groups = defaultdict(list)
    for c in combinations:
        groups[(c.spp, c.sampler, c.filter)].append(c)
    result = []
    for (spp, sampler, filter_), members in groups.items():
        if len(dumps) < 2 or len(members) < len(dumps):
            continue
        mean = Combination(("", spp, sampler, filter_))
        mean.replicates = sum(c.replicates for c in members)
        for name in names:
            interval = _geometric_mean([c.quantities.get(name) for c in members])
            if interval is not None:
                mean.quantities[name] = interval
        result.append(mean)
    return result


def _geometric_mean(intervals):
    if any(i is None or not 0.0 < i.mean < math.inf for i in intervals):
        return None
    n = len(intervals)
    mean = math.exp(sum(math.log(i.mean) for i in intervals) / n)
    if not all(0.0 < i.low <= i.high < math.inf for i in intervals):
        return Interval(n, mean)
    reach = math.sqrt(sum((math.log(i.high / i.low) / 2.0) ** 2 for i in intervals)) / n
    return Interval(n, mean, mean * math.exp(-reach), mean * math.exp(reach))


def _add_ratios(combinations):
    baselines = baseline_of(combinations)
    for combination in combinations:
        baseline = baselines.get((combination.dump, combination.spp))
        for name in RATIO_METRICS:
            if baseline is None or name not in combination.quantities:
                continue
            combination.quantities[name + "_ratio"] = ratio_to(combination, baseline, name)


def ratio_to(combination, baseline, metric):
    if combination is baseline:
        return Interval(len(combination.rows), 1.0)
    pairs = combination.pairs(baseline, metric)
    if combination.alike or baseline.alike:
        pairs = pairs[:1]
    return paired_ratio(pairs)
