"""The first screen's figures: rankings with their pairs, as statistics.json has them."""

from tools.report.statistics_file import interval_of

WORDS = ("better", "worse", "undecided", "identical")
MOST_PAIRS = 60000  # in the page; beyond, only ratios to the baseline


def headline_conditions(statistics, metric, combinations, dumps):
    """[{dump, spp, field: places in `combinations`, best first, alone: the first is separated from all others, pairs}]"""
    index = {c.key: i for i, c in enumerate(combinations)}
    conditions = statistics.of_metric(metric)
    with_pairs = sum(len(c.get("pairs") or []) for c in conditions) <= MOST_PAIRS
    found = []
    for condition in conditions:
        ranking = condition["ranking"]
        field = [index[condition["dump"], condition["spp"], e["sampler"], e["filter"]] for e in ranking]
        pairs = [_pair(*pair) for pair in condition.get("pairs") or []] if with_pairs else []
        found.append({"dump": dumps.index(condition["dump"]), "spp": condition["spp"], "field": field,
                      "alone": best_is_alone(ranking), "pairs": pairs})
    return found


def headline_budget(statistics, metric):
    """The budget that is shown first: the largest."""
    return max((c["spp"] for c in statistics.of_metric(metric)), default=0.0)


def best_is_alone(ranking):
    """Whether the file separates the first of a ranking from every other: only then it may be printed as the best."""
    others = [entry for entry in ranking[1:] if entry["compared"]]
    return bool(others) and ranking[0]["compared"] and all(e.get("against_best") == "worse" for e in others)


def _pair(a, b, ratio, low, high, _, verdict):
    mean = interval_of([ratio, low, high])
    short = [None if n != n else float(f"{n:.5g}") for n in mean]
    return [a, b, *short, WORDS.index(verdict) if verdict in WORDS else 2]
