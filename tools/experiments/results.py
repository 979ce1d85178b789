"""Reads what `spool evaluate` wrote: figures and verdicts of statistics.json, and the rows of single replicates.

A verdict between two methods of one plan is that of statistics.json, which decides all pairs of a recording and budget
together, unless judge_asked() decided those together that were asked for. No figure is computed here.
"""
import json
import math
import sys
from pathlib import PurePosixPath

import measured
from inference import ORDER, Interval, interval_of, judged_together, ratio_of

VERSION = 1


def canonical(label):
    """A method's label with its options in alphabetical order: name{a=1,b=2}."""
    name, brace, options = label.partition("{")
    return name + (brace + ",".join(sorted(options.removesuffix("}").split(","))) + "}" if brace else "")


def options(name, text):
    """The label of a method with these options."""
    return f"{name}{{{text}}}"


def _pool(path):
    return PurePosixPath(path).stem


def _name(entry):
    return canonical(entry["sampler"]), canonical(entry["filter"])


def read_statistics(folder):
    data = json.loads((folder / "statistics.json").read_text())
    if data.get("version") != VERSION:
        sys.exit(f"{folder}: statistics.json is of another version: run spool evaluate --statistics-only {folder}")
    return data


class Results:
    """The results of one folder or file of measured.py or several, by (pool, sampler, filter, spp, threads)."""

    def __init__(self, folders):
        self.folders = list(folders)
        self._rows, self._figures, self.failed = {}, {}, {}
        self._pairs = {}  # (pool, spp, threads, metric): {(method, method): (verdict of the first, ratio)}
        self._overall = {}  # (sampler, filter, spp, threads, metric): [ratio of each folder]
        self._asked = {}  # (pool, spp, threads, metric): {(method, method): order of judge_asked(), or None}
        self._best = {}   # (pool, spp, threads, metric): methods by mean with (letters, against the best)
        for folder in self.folders:
            if folder.is_dir():
                rows, statistics = map(json.loads, (folder / "results.jsonl").read_text().splitlines()), read_statistics(folder)
            else:
                rows, statistics = measured.load(folder)
            for row in rows:
                self._add(row)
            self._add_statistics(statistics)
        for rows in self._rows.values():
            rows.sort(key=lambda row: row["replicate"])

    def _add(self, row):
        key = (_pool(row.get("dump_path", row["dump"])), *_name(row), row["spp"], row["threads"])
        if row["error"]:
            self.failed[key] = row["error"]
        else:
            self._rows.setdefault(key, []).append(row)

    def _add_statistics(self, statistics):
        for entry in statistics["results"]:
            key = (_pool(entry["dump"]), *_name(entry), entry["spp"], entry["threads"])
            self._figures[key] = {name: interval_of(v) for name, v in entry.get("quantities", {}).items()}
        for condition in statistics["conditions"]:
            key = (_pool(condition["dump"]), condition["spp"], condition["threads"], condition["metric"])
            methods = [_name(entry) for entry in condition["ranking"]]
            self._best[key] = [(name, entry.get("against_best", "best" if entry["compared"] else "not compared"))
                               for name, entry in zip(methods, condition["ranking"])]
            pairs = self._pairs.setdefault(key, {})
            for a, b, *ratio, _, verdict in condition.get("pairs", []):
                pairs[methods[a], methods[b]] = verdict, interval_of(ratio if ratio[0] is not None else [])
        for entry in statistics["overall"]:
            for metric, found in entry.get("against_baseline", {}).items():
                key = (*_name(entry), entry["spp"], entry["threads"], metric)
                self._overall.setdefault(key, []).append(interval_of(found["ratio"]))

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
        for kept, all_of_them in ((part._rows, self._rows), (part._figures, self._figures), (part.failed, self.failed)):
            kept.update((k, v) for k, v in all_of_them.items() if k[1] in samplers and k[2] in filters)
        part._pairs, part._best, part._overall, part._asked = self._pairs, self._best, self._overall, self._asked
        return part

    def _threads(self, threads):
        return self.threads[0] if threads is None else threads

    def rows(self, pool, sampler, filter_name, spp, threads=None):
        return self._rows.get((pool, canonical(sampler), canonical(filter_name), spp, self._threads(threads)), [])

    def values(self, column, *cell):
        """One number per replicate; empty where the cell failed or was not run, and for a column that was not asked for (fresh)."""
        values = [row.get(column) for row in self.rows(*cell)]
        return [] if None in values else [float(value) for value in values]

    def figure(self, column, pool, sampler, filter_name, spp, threads=None):
        """Mean and 95 % interval of a quantity."""
        key = (pool, canonical(sampler), canonical(filter_name), spp, self._threads(threads))
        return self._figures.get(key, {}).get(column, Interval())

    def _pair(self, column, pool, spp, a, b, threads):
        pairs = self._pairs.get((pool, spp, self._threads(threads), column), {})
        a, b = (tuple(map(canonical, method)) for method in (a, b))
        if (a, b) in pairs:
            return pairs[a, b]
        verdict, ratio = pairs.get((b, a), ("not compared", Interval()))
        swapped = {"better": "worse", "worse": "better"}
        turned = [1.0 / r for r in (ratio.mean, ratio.high, ratio.low)] if ratio.mean == ratio.mean else []
        return swapped.get(verdict, verdict), interval_of(turned)

    def ratio(self, column, pool, spp, a, b, threads=None):
        """Error of method a over that of b."""
        return self._pair(column, pool, spp, a, b, threads)[1]

    def order(self, column, pool, spp, a, b, threads=None):
        """-1 where a is below b, 1 above, 0 not told apart, None not compared."""
        a, b = (tuple(map(canonical, method)) for method in (a, b))
        asked = self._asked.setdefault((pool, spp, self._threads(threads), column), {})
        turned = (b, a) in asked
        judged = asked[b, a] if turned else asked.setdefault((a, b))
        if judged is None:
            return ORDER[self._pair(column, pool, spp, a, b, threads)[0]]
        return -judged if turned else judged

    def judge_asked(self):
        """Decides the pairs that order() was asked for since the last time: those of one recording, budget and metric are one
        family. A pair without a ratio keeps its verdict among all pairs."""
        for (pool, spp, threads, column), asked in self._asked.items():
            ratios = {pair: self.ratio_or_made(column, pool, spp, *pair, threads) for pair in asked}
            known = [pair for pair, ratio in ratios.items() if ratio.mean == ratio.mean]
            freedom = [len(self.rows(pool, *a, spp, threads)) - 1 for a, _ in known]
            asked.update(zip(known, judged_together([ratios[pair] for pair in known], freedom)))

    def ratio_or_made(self, column, pool, spp, a, b, threads=None):
        """The ratio; where measured.py did not keep it, from the replicates, and as much wider as those of the two methods to
        uniform + box, which are kept, are wider than their replicates alone say: replicates may share samples."""
        kept = self.ratio(column, pool, spp, a, b, threads)
        made = ratio_of(*(self.values(column, pool, *method, spp, threads) for method in (a, b)))
        if kept.mean == kept.mean or made.mean != made.mean:
            return kept
        wider, plain = [1.0], column.removesuffix("_fresh")  # no ratio of an error on fresh samples is kept
        for method in {a, b} - {measured.BASE}:
            both = [self.values(plain, pool, *m, spp, threads) for m in (method, measured.BASE)]
            if both[0] == both[1]:  # the very samples of uniform + box: no width to learn from
                continue
            alone = ratio_of(*both)
            to_base = self.ratio(plain, pool, spp, method, measured.BASE, threads)
            if not to_base.mean > 0 or not alone.high > alone.low:
                return kept
            wider.append(math.log(to_base.high / to_base.low) / math.log(alone.high / alone.low))
        low, high = (made.mean * (end / made.mean) ** max(wider) for end in (made.low, made.high))
        return Interval(made.mean, low, high)

    def overall(self, column, sampler, filter_name, spp, threads=None):
        """Ratio to uniform + box, geometric mean over the recordings of each folder: [Interval]."""
        key = (canonical(sampler), canonical(filter_name), spp, self._threads(threads), column)
        return self._overall.get(key, [])

    def ranked(self, column, pool, spp, threads=None):
        """[((sampler, filter), verdict against the best)], best mean first."""
        return self._best.get((pool, spp, self._threads(threads), column), [])
