"""What statistics.json says, in sentences. A verdict in a sentence is one of the file's; none is made here."""

import math
from collections import Counter
from typing import NamedTuple

from tools.report.metric_names import metric_name
from tools.report.number_text import (
    count_text,
    interval_text,
    list_text,
    number_text,
    percent_text,
    ratio_text,
)
from tools.report.statistics_file import best_is_alone, interval_of

SATURATION_LIMIT = 0.01
LONGEST_LIST = 6
MOST_LEADING = 5


class Sentence(NamedTuple):
    text: str
    kind: str = "finding"  # scope, about, finding, warning, energy
    spp: float = 0.0  # of a finding: its budget


def summarise(combinations, statistics, metric, labels):
    """Sentences; `labels` gives each scene's short name."""
    sentences = [scope(combinations, labels), *abouts(statistics, metric, labels)]
    sentences += failures(combinations, labels)
    for condition in statistics.of_metric(metric):
        sentences.append(best_of(condition, statistics.metric_text(metric), labels, statistics.baseline)._replace(spp=condition["spp"]))
    sentences += energy(combinations, labels)
    return [*sentences, *cautions(combinations, metric, labels), *support(statistics, metric, labels)]


def leading(sentences, statistics, metric, budget):
    """At most five sentences for the first screen: what spoils everything, who is best at one budget, energy."""
    severe = [s for s in sentences if s.kind == "warning"][:1]
    best = [s for s in sentences if s.kind == "finding" and s.spp == budget]
    energies = [s for s in sentences if s.kind == "energy"][:1]
    if len(best) > 3:
        best = _counted(statistics, metric, budget)
    return (severe + best + energies)[:MOST_LEADING]


def _counted(statistics, metric, budget):
    """Of many scenes: how often the two that most often come first do so, and how often they are separated."""
    everywhere = [c for c in statistics.of_metric(metric) if c["spp"] == budget]
    conditions = [c for c in everywhere if any(e["compared"] for e in c["ranking"])]
    scenes = f"{len(conditions)} scenes" + (" where methods are compared" if len(conditions) < len(everywhere) else "")
    first, alone = Counter(), Counter()
    for condition in conditions:
        name = name_of(condition["ranking"][0])
        first[name] += 1
        alone[name] += best_is_alone(condition)
    return [Sentence(f"At {budget:g} spp, {name} comes first on {count} of {scenes}, and is separated "
                     f"from every other method that is compared on {alone[name]} of them.") for name, count in first.most_common(2)]


def scope(combinations, labels):
    dumps = list(dict.fromkeys(c.dump for c in combinations))
    methods = list(dict.fromkeys(c.method for c in combinations))
    budgets = sorted({c.spp for c in combinations})
    replicates = sorted({c.replicates for c in combinations})
    several = (f"{replicates[0]:g}" if len(replicates) == 1
               else f"{replicates[0]:g} to {replicates[-1]:g}")
    named = list_text([labels[d] for d in dumps], LONGEST_LIST)
    return Sentence(
        f"{count_text(len(dumps), 'scene')} ({named}), "
        f"{count_text(len(methods), 'combination')} of sampler and filter, "
        f"{list_text([f'{b:g}' for b in budgets], LONGEST_LIST)} samples per pixel, "
        f"{several} {'replicate' if several == '1' else 'replicates'} each: "
        f"{count_text(sum(c.replicates for c in combinations), 'result')}.", "scope")


def abouts(statistics, metric, labels):
    """What the intervals and verdicts are about, once where it is the same everywhere."""
    texts = {}
    for c in statistics.of_metric(metric):
        texts.setdefault(c["about"]["text"], []).append(f"{labels[c['dump']]} at {c['spp']:g} spp")
    return [Sentence(f"Intervals and verdicts {f'of {list_text(places, LONGEST_LIST)} ' if len(texts) > 1 else ''}are about {text}.", "about")
            for text, places in texts.items()]


def failures(combinations, labels):
    failed = [c for c in combinations if c.failures]
    if not failed:
        return []
    first = failed[0]
    return [Sentence(f"{count_text(sum(len(c.failures) for c in failed), 'result')} failed; the "
                     f"first: {first.method} on {labels[first.dump]} at {first.spp:g} spp: "
                     f"{first.failures[0]}.", "warning")]


def name_of(entry):
    return f"{entry['sampler']} + {entry['filter']}"


def unjudged(entry):
    """Why there is no verdict on a method; empty where there is."""
    return entry.get("withheld") or ("" if entry["compared"] else "not compared")


def threads_text(claim, place):
    """Of a claim about times at one place."""
    threads = place.get("threads", 0) if claim["metric"].startswith("seconds_") else 0
    return f", {count_text(threads, 'thread')}" if threads else ""


def late_text(claim):
    """Of a claim: whether it was there before the results."""
    return " (added after results)" if claim.get("after_results") else ""


def verdict_text(place):
    """Of a claim at one place: the verdict, and why there is none."""
    return place["verdict"] + (f": {place['withheld']}" if "withheld" in place else "")


AGAINST = {"better": "worse than", "worse": "better than", "undecided": "not separated from", "identical": "identical to",
           "not compared": "not compared with"}  # what a verdict against the first says of the first


def best_of(condition, metric, labels, baseline):
    where = f"{labels[condition['dump']]} at {condition['spp']:g} spp"
    field = condition["ranking"]
    best, rest = field[0], field[1:]
    value = f"{metric} {interval_text(interval_of(best['value']))}{_lost(best)}"
    if not rest:
        return Sentence(f"{where}: {name_of(best)}, alone, has {value}.")
    if not best["compared"] or condition["about"]["kind"] == "one image":
        return Sentence(f"{where}: {name_of(best)} comes first, {value}; without independent "
                        "replicates nothing can be said about differences.")
    said = {}
    for entry in rest:
        said.setdefault(entry.get("against_best", "not compared"), []).append(name_of(entry))
    alone = best_is_alone(condition)
    clauses = [f"{AGAINST[word]} {list_text(names, LONGEST_LIST)}" for word, names in said.items() if not (alone and word == "worse")]
    text = f"{where}: {name_of(best)} {'has the lowest error' if alone else 'comes first'}, {value}"
    return Sentence("; ".join([text, *clauses]) + f"{_against_baseline(best, baseline)}.")


def _lost(entry):
    return f" (it loses {percent_text(entry['loses_energy'])} of the energy)" if "loses_energy" in entry else ""


def _against_baseline(entry, baseline):
    if entry.get("against_baseline") != "better":
        return ""
    ratio = interval_of(entry.get("ratio"))
    if math.isnan(ratio.mean):
        return f"; it is better than {baseline} by a ratio that is not resolved"
    return f"; it has {ratio_text(ratio)} times the error of {baseline}"


class Verdict(NamedTuple):
    """A method against the baseline at one budget."""
    ratio: object  # Interval
    said: Counter  # {verdict: on how many scenes}


def said_text(said):
    """"2 better, 1 not compared"; the word alone of one scene."""
    return next(iter(said)) if sum(said.values()) == 1 else ", ".join(f"{said[word]} {word}" for word in AGAINST if said[word])


def verdicts(statistics, metric):
    """{(method, spp): Verdict} for the methods with a baseline beside them."""
    ratios = {(name_of(e), e["spp"]): e.get("against_baseline", {}).get(metric, {}).get("ratio") for e in statistics.overall}
    result = {}
    for condition in statistics.of_metric(metric):
        for entry in condition["ranking"]:
            if "against_baseline" in entry:
                key = name_of(entry), condition["spp"]
                ratio = ratios.get(key) if len(statistics.scenes) > 1 else entry.get("ratio")
                result.setdefault(key, Verdict(interval_of(ratio), Counter())).said[entry["against_baseline"]] += 1
    return result


def energy(combinations, labels):
    known = [c for c in combinations if math.isfinite(c.quantity("energy_ratio").mean)]
    lost = {c.key: entry["loses_energy"] for c in known for entry in c.ranks.values() if "loses_energy" in entry}
    if not known:
        return []
    if not lost:
        return [Sentence("Energy: no combination is shown to lose more than 2 % of the light, beyond its interval.", "energy")]
    worst = max((c for c in known if c.key in lost), key=lambda c: lost[c.key])
    return [Sentence(f"Energy: {len(lost)} of {count_text(len(known), 'combination')} lose light; the most, "
                     f"{worst.method} on {labels[worst.dump]} at {worst.spp:g} spp, loses "
                     f"{100 * lost[worst.key]:.1f} % (ratio {interval_text(worst.quantity('energy_ratio'))}).", "energy")]


FEW_PIXELS = 0.2  # of the error in the worst 0.1 % of the pixels: remarked


def support(statistics, metric, labels):
    """Errors that stand on few pixels, and verdicts that are withheld for what they stand on."""
    known = [(interval_of(r.get("quantities", {}).get(f"{metric}_half_pixels")).mean,
              interval_of(r["quantities"].get(f"{metric}_worst_share")).mean, r) for r in statistics.results if r.get("quantities")]
    few = [entry for entry in known if entry[1] >= FEW_PIXELS]
    if few:
        half, share, worst = min(few, key=lambda entry: entry[0])
        pixels = round(max(1.0, half))
        yield Sentence(
            f"{count_text(len(few), 'result')} stand{'s' if len(few) == 1 else ''} on few pixels: of {name_of(worst)} on {labels[worst['dump']]} at "
            f"{worst['spp']:g} spp, {count_text(pixels, 'pixel')} bear{'s' if pixels == 1 else ''} half of the {metric_name(metric)}, the worst 0.1 % {100 * share:.0f} %.", "warning")
    reasons = Counter(e["withheld"] for c in statistics.of_metric(metric) for e in c["ranking"] if "withheld" in e)
    for reason, count in reasons.items():
        yield Sentence(f"{count_text(count, 'result')} without verdict on {metric_name(metric)}: {reason}.", "warning")


def cautions(combinations, metric, labels):
    saturated = [c for c in combinations if c.quantity("saturated_share").mean > SATURATION_LIMIT]
    if saturated:
        worst = max(saturated, key=lambda c: c.quantity("saturated_share").mean)
        yield Sentence(
            f"{count_text(len(saturated), 'combination')} ran out of recorded samples in more than "
            f"{100 * SATURATION_LIMIT:g} % of the pieces (most: {worst.method} on "
            f"{labels[worst.dump]} at {worst.spp:g} spp, "
            f"{100 * worst.quantity('saturated_share').mean:.1f} %): a longer recording may change "
            "their order.", "warning")
    short = [c for c in combinations if c.quantity("samples_per_pixel").mean < 0.999 * c.spp]
    if short:
        yield Sentence(
            f"{count_text(len(short), 'combination')} spent less than the budget, first "
            f"{short[0].method} on {labels[short[0].dump]}: "
            f"{number_text(short[0].quantity('samples_per_pixel').mean)} of {short[0].spp:g} "
            "samples per pixel.", "warning")
    unresolved = [c for c in combinations if c.quantity(metric).low <= 0.0]
    if unresolved:
        yield Sentence(
            f"{count_text(len(unresolved), 'combination')} ha{'s' if len(unresolved) == 1 else 've'} a {metric_name(metric)} whose interval reaches "
            "zero: the error is not resolved.", "warning")
    alike = sum(c.one_image and c.replicates - len(c.failures) > 1 for c in combinations)
    if alike:
        yield Sentence(
            f"The replicates of {count_text(alike, 'combination')} are one image: "
            "their intervals are those of its blocks of pixels, and they are not compared.",
            "warning")
