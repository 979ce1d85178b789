"""Says whether multiscale + directional meets its target on a pool at a budget, and where it does not, why.

The target: relMSE at or below that of each rival, energy ratio within 0.97 .. 1.03.
"""
import math
from dataclasses import dataclass

from results import T_QUANTILE, mean, order, ratio, standard_error
from tables import number, with_error
from tuning_choice import outside

RIVALS = [("greedy_error", "greedy_selection"), ("uniform", "nl_means"), ("nl_means", "nl_means")]

MET, NOISE, MISSED, UNKNOWN = "met", "missed within the noise", "missed", "not measured"


@dataclass(frozen=True)
class Verdict:
    rivals: tuple  # one word per rival
    energy: str

    @property
    def word(self):
        words = (*self.rivals, self.energy)
        return next(w for w in (UNKNOWN, MISSED, NOISE, MET) if w in words)


def against(ours, theirs):
    """Of one rival, from relMSE over the same replicates."""
    if not ours or len(ours) != len(theirs):
        return UNKNOWN
    if mean(ours) <= mean(theirs):
        return MET
    return MISSED if order(ours, theirs) == 1 else NOISE


def of_energy(values):
    if not values:
        return UNKNOWN
    beyond = outside(mean(values))
    if beyond == 0:
        return MET
    reach = T_QUANTILE[min(len(values) - 1, max(T_QUANTILE))] * standard_error(values) if len(values) > 1 else 0.0
    return NOISE if beyond <= reach else MISSED


def verdict(results, pool, spp, sampler, filter_name):
    ours = results.values("relmse", pool, sampler, filter_name, spp)
    return Verdict(tuple(against(ours, results.values("relmse", pool, *rival, spp)) for rival in RIVALS),
                   of_energy(results.values("energy_ratio", pool, sampler, filter_name, spp)))


def with_interval(a, b):
    """Ratio of the means with its 95 % interval."""
    found = ratio(a, b)
    if not found:
        return "–"
    reach = T_QUANTILE[min(len(a) - 1, max(T_QUANTILE))] * found[1] if len(a) > 1 else 0.0
    return f"{number(found[0])} ({number(max(0.0, found[0] - reach))} .. {number(found[0] + reach)})"


def _times(a, b):
    return with_error(*ratio(a, b)) if ratio(a, b) else "–"


def error_parts(results, pool, spp, ours, rival):
    """relMSE over the rival's: ours, with the rival's filter on our samples, with our filter on the rival's samples; which
    of the two loses, as the exchange says; the share of our error in the worst 0.1 % of the pixels."""
    def errors(*method):
        return results.values("relmse", pool, *method, spp)

    own, other = errors(*ours), errors(*rival)
    their_filter, their_samples = errors(ours[0], rival[1]), errors(rival[0], ours[1])
    least = min((mean(values), name) for values, name in (
        (their_filter, "the filter"), (their_samples, "the sampler"), (own, "only both together")) if values)
    dropped = results.values("relmse_dropped", pool, *ours, spp)
    worst = f"{100 * mean(dropped) / mean(own):.0f} %" if dropped and mean(own) > 0 else "–"
    return _times(own, other), _times(their_filter, other), _times(their_samples, other), least[1], worst


def reasons(results, pool, spp, ours):
    """(rival, verdict, the parts) of each rival that is missed."""
    found = verdict(results, pool, spp, *ours)
    return [(" + ".join(rival), word, *error_parts(results, pool, spp, ours, rival))
            for word, rival in zip(found.rivals, RIVALS) if word in (MISSED, NOISE)]


def energy_parts(results, pool, spp, ours):
    """Energy ratio; what the samples alone (box) and then the filter change; that of the filter on uniform samples."""
    energy, boxed, evenly = (mean(results.values("energy_ratio", pool, *method, spp) or [math.nan])
                             for method in (ours, (ours[0], "box"), ("uniform", ours[1])))
    return f"{energy:.3f}", f"{100 * (boxed - 1):+.1f} %", f"{100 * (energy - boxed):+.1f} %", f"{evenly:.3f}"
