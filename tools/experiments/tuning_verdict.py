"""Says whether multiscale + directional meets its target on a pool at a budget, and where it does not, why.

The target: relMSE at or below that of each rival, energy ratio within 0.97 .. 1.03.
"""
import math
from dataclasses import dataclass

from tables import with_interval
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


def against(results, pool, spp, ours, rival):
    """Of one rival, as statistics.json decides it."""
    order = results.order("relmse", pool, spp, ours, rival)
    if order is None:
        return UNKNOWN
    if results.figure("relmse", pool, *ours, spp).mean <= results.figure("relmse", pool, *rival, spp).mean:
        return MET
    return MISSED if order == 1 else NOISE


def of_energy(found):
    """From the energy ratio and its interval."""
    if math.isnan(found.mean):
        return UNKNOWN
    if outside(found.mean) == 0:
        return MET
    return NOISE if outside(found.low) == 0 or outside(found.high) == 0 else MISSED


def verdict(results, pool, spp, sampler, filter_name):
    return Verdict(tuple(against(results, pool, spp, (sampler, filter_name), rival) for rival in RIVALS),
                   of_energy(results.figure("energy_ratio", pool, sampler, filter_name, spp)))


def error_parts(results, pool, spp, ours, rival):
    """relMSE over the rival's: ours, with the rival's filter on our samples, with our filter on the rival's samples; which
    of the two loses, as the exchange says; the share of our error in the worst 0.1 % of the pixels."""
    def times(method):
        return with_interval(results.ratio("relmse", pool, spp, method, rival))

    own = results.figure("relmse", pool, *ours, spp)
    their_filter, their_samples = (ours[0], rival[1]), (rival[0], ours[1])
    known = [(results.figure("relmse", pool, *method, spp).mean, name) for method, name in (
        (their_filter, "the filter"), (their_samples, "the sampler"), (ours, "only both together"))]
    least = min((mean, name) for mean, name in known if mean == mean)
    dropped = results.figure("relmse_dropped", pool, *ours, spp).mean
    worst = f"{100 * dropped / own.mean:.0f} %" if dropped == dropped and own.mean > 0 else "–"
    return times(ours), times(their_filter), times(their_samples), least[1], worst


def reasons(results, pool, spp, ours):
    """(rival, verdict, the parts) of each rival that is missed."""
    found = verdict(results, pool, spp, *ours)
    return [(" + ".join(rival), word, *error_parts(results, pool, spp, ours, rival))
            for word, rival in zip(found.rivals, RIVALS) if word in (MISSED, NOISE)]


def energy_parts(results, pool, spp, ours):
    """Energy ratio; what the samples alone (box) and then the filter change; that of the filter on uniform samples."""
    energy, boxed, evenly = (results.figure("energy_ratio", pool, *method, spp).mean
                             for method in (ours, (ours[0], "box"), ("uniform", ours[1])))
    return f"{energy:.3f}", f"{100 * (boxed - 1):+.1f} %", f"{100 * (energy - boxed):+.1f} %", f"{evenly:.3f}"
