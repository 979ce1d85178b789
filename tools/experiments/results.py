"""Reads the results of `spool evaluate` and compares methods over replicates.

A replicate is the same order of samples for every method, so differences are taken within replicates.
"""
import json
import math
from pathlib import PurePosixPath

# Two-sided 95 % quantile of Student's t by degrees of freedom.
T_QUANTILE = {1: 12.706, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262}


def canonical(label):
    """A method's label with its options in alphabetical order: name{a=1,b=2}."""
    name, brace, options = label.partition("{")
    return name + (brace + ",".join(sorted(options.removesuffix("}").split(","))) + "}" if brace else "")


class Results:
    """The rows of one folder or several, by (pool, sampler, filter, spp, threads)."""

    def __init__(self, folders):
        self.folders = list(folders)
        self._rows, self.failed = {}, {}
        for folder in self.folders:
            for line in (folder / "results.jsonl").read_text().splitlines():
                self._add(json.loads(line))
        for rows in self._rows.values():
            rows.sort(key=lambda row: row["replicate"])

    def _add(self, row):
        key = (PurePosixPath(row["dump"]).stem, canonical(row["sampler"]), canonical(row["filter"]),
               row["spp"], row["threads"])
        if row["error"]:
            self.failed[key] = row["error"]
        else:
            self._rows.setdefault(key, []).append(row)

    def _names(self, index):
        return list(dict.fromkeys(key[index] for key in self._rows))

    @property
    def pools(self):
        return self._names(0)

    @property
    def samplers(self):
        return self._names(1)

    @property
    def filters(self):
        return self._names(2)

    @property
    def budgets(self):
        return sorted(set(self._names(3)))

    @property
    def threads(self):
        return sorted(set(self._names(4)))

    def only(self, samplers, filters):
        """The part with these methods."""
        part = Results([])
        part.folders = self.folders
        for kept, all_of_them in ((part._rows, self._rows), (part.failed, self.failed)):
            kept.update((k, v) for k, v in all_of_them.items() if k[1] in samplers and k[2] in filters)
        return part

    def rows(self, pool, sampler, filter_name, spp, threads=None):
        sampler, filter_name = canonical(sampler), canonical(filter_name)
        if threads is None:
            threads = self.threads[0]
        return self._rows.get((pool, sampler, filter_name, spp, threads), [])

    def values(self, column, *cell):
        """One number per replicate; empty where the cell failed or was not run."""
        values = [row[column] for row in self.rows(*cell)]
        return [] if None in values else [float(value) for value in values]


def mean(values):
    return sum(values) / len(values)


def standard_error(values):
    n, middle = len(values), mean(values)
    return math.sqrt(sum((v - middle) ** 2 for v in values) / (n - 1) / n) if n > 1 else math.nan


def ratio(a, b):
    """Ratio of the means and its standard error: jackknife over replicates that both have."""
    n = len(a)
    if n == 0 or len(b) != n or sum(b) == 0:
        return None
    whole = sum(a) / sum(b)
    if n == 1:
        return whole, math.nan
    left_out = [(sum(a) - a[i]) / (sum(b) - b[i]) for i in range(n)]
    middle = mean(left_out)
    return whole, math.sqrt((n - 1) / n * sum((x - middle) ** 2 for x in left_out))


def order(a, b):
    """-1 where a is below b beyond the noise (95 %, paired), 1 above, 0 neither, None unknown."""
    if len(a) < 2 or len(a) != len(b):
        return None
    differences = [x - y for x, y in zip(a, b, strict=True)]
    reach = T_QUANTILE[min(len(a) - 1, max(T_QUANTILE))] * standard_error(differences)
    middle = mean(differences)
    return -1 if middle + reach < 0 else 1 if middle - reach > 0 else 0
