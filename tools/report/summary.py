"""What the figures say, in sentences; a difference inside the noise is said to be undecided.

Within one recording and budget the combination with the lowest mean error is compared with each
other one, replicate by replicate, at a level of 95 % for all comparisons together (Bonferroni).
"""

import math
from typing import NamedTuple

from aggregate import BASELINE, baseline_of
from intervals import paired_difference
from number_text import count_text, factor_text, interval_text, list_text, number_text

ENERGY_TOLERANCE = 0.01
SATURATION_LIMIT = 0.01
LONGEST_LIST = 6


class Sentence(NamedTuple):
    text: str
    kind: str = "finding"  # scope, finding, warning


class Contest(NamedTuple):
    """The combinations of one recording and budget."""
    best: object
    worse: list  # told apart from the best
    undecided: list


def summarise(combinations, metric, labels):
    """Sentences; `labels` gives each recording's short name."""
    sentences = [scope(combinations, labels)]
    sentences += failures(combinations, labels)
    for dump, spp in conditions(combinations):
        field = [c for c in combinations if (c.dump, c.spp) == (dump, spp)]
        sentences.append(best_of(field, metric, labels))
    sentences += energy(combinations, labels)
    sentences += cautions(combinations, metric, labels)
    return [sentence for sentence in sentences if sentence is not None]


def conditions(combinations):
    return list(dict.fromkeys((c.dump, c.spp) for c in combinations))


def scope(combinations, labels):
    dumps = list(dict.fromkeys(c.dump for c in combinations))
    methods = list(dict.fromkeys(c.method for c in combinations))
    budgets = sorted({c.spp for c in combinations})
    replicates = sorted({c.replicates for c in combinations})
    several = (f"{replicates[0]:g}" if len(replicates) == 1
               else f"{replicates[0]:g} to {replicates[-1]:g}")
    named = list_text([labels[d] for d in dumps], LONGEST_LIST)
    return Sentence(
        f"{count_text(len(dumps), 'recording')} ({named}), "
        f"{count_text(len(methods), 'combination')} of sampler and filter, "
        f"{list_text([f'{b:g}' for b in budgets], LONGEST_LIST)} samples per pixel, "
        f"{several} {'replicate' if several == '1' else 'replicates'} each: "
        f"{count_text(sum(c.replicates for c in combinations), 'result')}.", "scope")


def failures(combinations, labels):
    failed = [c for c in combinations if c.failures]
    if not failed:
        return []
    first = failed[0]
    return [Sentence(f"{count_text(sum(len(c.failures) for c in failed), 'result')} failed; the "
                     f"first: {first.method} on {labels[first.dump]} at {first.spp:g} spp: "
                     f"{first.failures[0]}.", "warning")]


def contest(field, metric):
    """None where no combination has a finite error."""
    known = [c for c in field if math.isfinite(c.quantities[metric].mean)]
    if not known:
        return None
    best = min(known, key=lambda c: c.quantities[metric].mean)
    rivals = [c for c in known if c is not best]
    worse, undecided = [], []
    for rival in rivals:
        (worse if _larger(rival, best, metric, len(rivals)) else undecided).append(rival)
    return Contest(best, worse, undecided)


def _larger(rival, best, metric, comparisons):
    if rival.alike or best.alike:
        return False
    difference = paired_difference(rival.pairs(best, metric), 1.0 - 0.05 / comparisons)
    return difference.low > 0.0  # false where fewer than two replicates leave it unknown


def best_of(field, metric, labels):
    where = f"{labels[field[0].dump]} at {field[0].spp:g} spp"
    outcome = contest(field, metric)
    if outcome is None:
        return Sentence(f"{where}: no combination has a finite {metric}.", "warning")
    best, worse, undecided = outcome
    value = f"{metric} {interval_text(best.quantities[metric])}"
    if not worse and not undecided:
        return Sentence(f"{where}: {best.method}, alone, has {value}.")
    if max(c.independent_replicates for c in field) < 2:
        return Sentence(f"{where}: {best.method} has the smallest mean, {value}; without independent "
                        "replicates nothing can be said about differences.")
    if not worse:
        return Sentence(f"{where}: no difference is resolved between the {len(field)} combinations; "
                        f"the smallest mean is that of {best.method}, {value}.")
    text = f"{where}: {best.method} has the lowest error, {value}"
    if undecided:
        text = (f"{where}: {best.method} has the smallest mean, {value}, but is not told apart from "
                + list_text([c.method for c in undecided], LONGEST_LIST))
    return Sentence(f"{text}{_against_baseline(best, worse, metric)}.")


def _against_baseline(best, worse, metric):
    ratio = best.quantities.get(metric + "_ratio")
    if ratio is None or (best.sampler, best.filter) == BASELINE:
        return ""
    baseline = " + ".join(BASELINE)
    if any((c.sampler, c.filter) == BASELINE for c in worse):
        if not math.isfinite(ratio.low):
            return f"; it is lower than {baseline} by a ratio that is not resolved"
        return f"; it has {factor_text(ratio)} times the error of {baseline}"
    if not ratio.excludes(1.0):
        return f"; its ratio to {baseline} is not resolved"
    # One comparison is easier to decide than all of a field together: say which one this is.
    return f"; compared with {baseline} alone, it has {factor_text(ratio)} times its error"


class Verdict(NamedTuple):
    """A method against uniform + box at one budget, over all recordings."""
    ratio: float  # geometric mean of the ratios of means
    better: int
    worse: int
    undecided: int
    interval: object  # of the ratio, where there is one recording only


def verdicts(combinations, metric):
    """{(method, spp): Verdict} for the methods with a baseline beside them."""
    baselines = baseline_of(combinations)
    grouped = {}
    for c in combinations:
        ratio = c.quantities.get(metric + "_ratio")
        if ratio is None or baselines.get((c.dump, c.spp)) is c or not math.isfinite(ratio.mean):
            continue
        grouped.setdefault((c.method, c.spp), []).append(ratio)
    result = {}
    for key, ratios in grouped.items():
        positive = all(r.mean > 0.0 for r in ratios)
        mean = (math.exp(sum(math.log(r.mean) for r in ratios) / len(ratios)) if positive
                else float("nan"))
        better, worse = sum(r.high < 1.0 for r in ratios), sum(r.low > 1.0 for r in ratios)
        result[key] = Verdict(mean, better, worse, len(ratios) - better - worse,
                              ratios[0] if len(ratios) == 1 else None)
    return result


def energy(combinations, labels):
    known = [c for c in combinations if math.isfinite(
        c.quantities.get("energy_ratio", (0, float("nan")))[1])]
    off = [c for c in known if c.quantities["energy_ratio"].excludes(1.0)
           and abs(c.quantities["energy_ratio"].mean - 1.0) > ENERGY_TOLERANCE]
    if not known:
        return []
    if not off:
        return [Sentence("Energy: no combination is shown to miss the reference's mean by more than "
                         f"{100 * ENERGY_TOLERANCE:g} %.")]
    worst = max(off, key=lambda c: abs(c.quantities["energy_ratio"].mean - 1.0))
    ratio = worst.quantities["energy_ratio"]
    verb = "loses" if ratio.mean < 1.0 else "adds"
    return [Sentence(f"Energy: {len(off)} of {count_text(len(known), 'combination')} differ from the "
                     f"reference's mean by more than {100 * ENERGY_TOLERANCE:g} %; the furthest, "
                     f"{worst.method} on {labels[worst.dump]} at {worst.spp:g} spp, {verb} "
                     f"{100 * abs(1.0 - ratio.mean):.1f} % (ratio {interval_text(ratio)}).",
                     "warning")]


def is_biased(combinations):
    return any("biased" in row.get("reference", "") for c in combinations for row in c.rows.values())


def cautions(combinations, metric, labels):
    sentences = []
    if is_biased(combinations):
        sentences.append(Sentence(
            "Judged by the pool that the images were made of: every error here is too small, and by "
            "a different factor for each method. Do not compare methods by it.", "warning"))
    saturated = [c for c in combinations
                 if c.quantities["saturated_share"].mean > SATURATION_LIMIT]
    if saturated:
        worst = max(saturated, key=lambda c: c.quantities["saturated_share"].mean)
        sentences.append(Sentence(
            f"{count_text(len(saturated), 'combination')} ran out of recorded samples in more than "
            f"{100 * SATURATION_LIMIT:g} % of the pieces (most: {worst.method} on "
            f"{labels[worst.dump]} at {worst.spp:g} spp, "
            f"{100 * worst.quantities['saturated_share'].mean:.1f} %): a longer recording may change "
            "their order.", "warning"))
    short = [c for c in combinations
             if c.quantities["samples_per_pixel"].mean < 0.999 * c.spp]
    if short:
        sentences.append(Sentence(
            f"{count_text(len(short), 'combination')} spent less than the budget, first "
            f"{short[0].method} on {labels[short[0].dump]}: "
            f"{number_text(short[0].quantities['samples_per_pixel'].mean)} of {short[0].spp:g} "
            "samples per pixel.", "warning"))
    unresolved = [c for c in combinations if c.quantities[metric].low <= 0.0]
    if unresolved:
        sentences.append(Sentence(
            f"{count_text(len(unresolved), 'combination')} have a {metric} whose interval reaches "
            "zero: their error is at the noise of the reference.", "warning"))
    alike = sum(c.alike for c in combinations)
    if alike:
        sentences.append(Sentence(
            f"The replicates of {count_text(alike, 'combination')} repeat each other exactly (taken "
            "in recorded order?): their intervals are those of the pixels, and they are not compared.",
            "warning"))
    return sentences
