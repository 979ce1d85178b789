"""The figures of a report as JSON for its scripts: combinations, quantities, pictures.

Only sums over replicates go in: a page stays usable with ten thousand results.
"""

import math

from tools.report.aggregate import RATIO_METRICS, TIMES
from tools.report.figure_methods import own_methods
from tools.report.figure_windows import choose_windows
from tools.report.number_text import digits_of_ratio
from tools.report.result_images import exposure_and_mean
from tools.report.statistics_file import Interval, best_is_alone, interval_of
from tools.report.summary import name_of, said_text, verdicts

QUANTITIES_LAST = TIMES + ("samples_per_pixel", "saturated_share", "efficiency")
WORDS = ("better", "worse", "undecided", "identical", "not compared")
MOST_PAIRS = 60000  # in the page; beyond, only ratios to the baseline
OWN_MEANINGS = {
    "samples_per_pixel": "samples taken, per pixel",
    "mse_ratio": "mse / mse of the baseline at the same budget",
    "relmse_ratio": "relmse / relmse of the baseline at the same budget",
}


def quantity_names(combinations, metrics):
    """In the order of the table: metrics with their ratios, then samples and times; known ones."""
    ordered = []
    for name in metrics:
        ordered += [name, name + "_ratio"] if name in RATIO_METRICS else [name]
    known = {name for c in combinations for name, q in c.quantities.items() if q.mean == q.mean}
    return [name for name in ordered + list(QUANTITIES_LAST) if name in known]


def report_data(combinations, statistics, metrics, metric, labels, vocabulary, images, pixels):
    names = quantity_names(combinations, metrics)
    own, against = own_methods(statistics.results, frozenset()), verdicts(statistics, metric)
    dumps = list(dict.fromkeys(c.dump for c in combinations))
    samplers = list(dict.fromkeys(c.sampler for c in combinations))
    filters = list(dict.fromkeys(c.filter for c in combinations))
    return {
        "dumps": [labels[dump] for dump in dumps],
        "samplers": samplers,
        "filters": filters,
        "metric": metric,
        "names": {name: statistics.metric_text(name) for name in metrics},
        "better": {name: vocabulary.better(name) for name in metrics},
        "baseline": statistics.baseline,
        "lettersNote": statistics.letters_note(metric),
        "metrics": [name for name in names if name in metrics],
        "quantities": [{"name": name, "meaning": OWN_MEANINGS.get(name) or vocabulary.meaning(name)} for name in names],
        # What the user added, which is what a page opens on.
        "own": list(own),
        "combinations": [_combination(c, dumps.index(c.dump), samplers, filters, names, metric, statistics.baseline) for c in combinations],
        # For the charts only: the recording after the last one.
        "overall": [_overall(entry, len(dumps), samplers, filters, names, against) for entry in statistics.overall],
        "budget": statistics.largest_budget(metric),
        "conditions": _conditions(statistics.of_metric(metric), {c.key: i for i, c in enumerate(combinations)}, dumps),
        "pixels": [{"dump": dumps.index(dump), **answers} for dump, answers in pixels.items()],
        "pictures": _pictures(images, combinations, dumps),
    }


def _conditions(conditions, index, dumps):
    """[{dump, spp, field: places of combinations, best first, alone: the first is separated from all others, pairs}]"""
    with_pairs = sum(len(c.get("pairs") or []) for c in conditions) <= MOST_PAIRS
    return [{"dump": dumps.index(c["dump"]), "spp": c["spp"],
             "field": [index[c["dump"], c["spp"], e["sampler"], e["filter"]] for e in c["ranking"]], "alone": best_is_alone(c),
             "pairs": [_pair(*pair) for pair in c.get("pairs") or []] if with_pairs else []} for c in conditions]


def _pair(a, b, ratio, low, high, _, verdict):
    # Of a ratio near 1 as many digits as the page may print.
    short = [None if n != n else float(f"{n:.{digits_of_ratio(n, 5)}g}") for n in interval_of([ratio, low, high])]
    return [a, b, *short, WORDS.index(verdict if verdict in WORDS else "not compared")]


def _combination(c, dump, samplers, filters, names, metric, baseline):
    return {"dump": dump, "sampler": samplers.index(c.sampler), "filter": filters.index(c.filter),
            "spp": c.spp, "replicates": c.replicates, "failed": len(c.failures),
            "values": [_interval(c.quantity(name)) for name in names],
            # Share of the energy that the file calls lost; 0 where it does not.
            "loses": next((_short(e["loses_energy"]) for e in c.ranks.values() if "loses_energy" in e), 0),
            # Of each number of threads there is one; its name alone would not say it.
            "baseline": bool(baseline) and metric in c.ranks and "against_baseline" not in c.ranks[metric],
            # By metric: letters of its group, and the verdict against the baseline.
            "ranks": {metric: [entry["letters"], entry.get("against_baseline", "")]
                      for metric, entry in c.ranks.items()}}


def _overall(entry, dump, samplers, filters, names, against):
    found = {name: interval_of(value) for name, value in entry["quantities"].items()}
    for name in RATIO_METRICS:
        found[name + "_ratio"] = interval_of(entry.get("against_baseline", {}).get(name, {}).get("ratio"))
    verdict = against.get((name_of(entry), entry["spp"]))
    return {"dump": dump, "sampler": samplers.index(entry["sampler"]), "filter": filters.index(entry["filter"]),
            "spp": entry["spp"], "replicates": 0, "failed": 0, "ranks": {}, "loses": 0,
            "against": said_text(verdict.said) if verdict else "",
            "values": [_interval(found.get(name, Interval())) for name in names]}


def _interval(interval):
    """[mean, low, high], [mean] without bounds, nothing when unknown."""
    if math.isnan(interval.mean):
        return []
    if math.isinf(interval.mean):
        return ["Infinity" if interval.mean > 0 else "-Infinity"]
    if not (math.isfinite(interval.low) and math.isfinite(interval.high)):
        return [_short(interval.mean)]
    return [_short(interval.mean), _short(interval.low), _short(interval.high)]


def _short(value):
    """Seven digits: more than is shown, less than doubles the size of the page."""
    value = float(f"{value:.7g}")
    return int(value) if value == int(value) and abs(value) < 1e15 else value


def _windows(images, combinations, dump, guide, exposure):
    """Where the methods differ to the eye at the largest budget, as in a figure: of the pictures that are in the page."""
    shown = [(combinations[s.combination].spp, s.images["estimate"]) for s in images.sets
             if combinations[s.combination].dump == dump and "estimate" in s.images]
    most = max((spp for spp, _ in shown), default=0.0)
    reference = images.packed[guide].values
    same = [images.packed[i].values for spp, i in shown if spp == most and images.packed[i].values.shape == reference.shape]
    return [crop._asdict() for crop in choose_windows(same or [reference], reference, exposure)]


def _pictures(images, combinations, dumps):
    scenes = {}
    for entry in images.sets:
        dump = combinations[entry.combination].dump
        guide = entry.images.get("reference", entry.images.get("estimate"))
        if dump in scenes or guide is None:
            continue
        exposure, mean = exposure_and_mean(images.packed[guide].values)
        crop, (width, height) = images.crops.get(dump), images.sizes[dump]
        scenes[dump] = {"dump": dumps.index(dump), "exposure": exposure, "mean": mean,
                        "width": width, "height": height, "crop": list(crop) if crop else None,
                        "windows": _windows(images, combinations, dump, guide, exposure)}
    return {
        "scenes": list(scenes.values()),
        "images": [p.header() for p in images.packed],
        "sets": [{"combination": s.combination, "images": s.images, "links": s.links}
                 for s in images.sets],
    }
