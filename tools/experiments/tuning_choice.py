"""Chooses among candidates of one method: by the pools that it is given, and by no other.

Score of a candidate on a pool, lower is better: the mean over budgets and replicates of
    ln(relMSE / relMSE of the defaults) + ENERGY_WEIGHT * (distance of the energy ratio from 0.97 .. 1.03).
On several pools: the mean of theirs.
"""
import math
from dataclasses import dataclass

from inference import mean_and_error

ENERGY_BAND = (0.97, 1.03)
ENERGY_WEIGHT = 2.0  # 1 % of energy beyond the band counts as 2 % of relMSE
LEAST_RATIO = 1e-3   # errors are debiased: the mean of a few may be 0 or below


@dataclass(frozen=True)
class Candidate:
    sampler: tuple  # ((option, value), ...) that differ from the defaults
    filter: tuple
    place: int      # in the plan

    @property
    def changes(self):
        return len(self.sampler) + len(self.filter)


@dataclass(frozen=True)
class Choice:
    candidate: Candidate
    best: Candidate       # with the least score
    tied: int             # candidates level with the best, the best among them
    score: float          # of `candidate`
    default_score: float  # of the candidate without changes; NaN where it is not one


def average(values):
    values = list(values)
    return sum(values) / len(values)


def outside(energy):
    """How far an energy ratio is outside the band."""
    return max(0.0, ENERGY_BAND[0] - energy, energy - ENERGY_BAND[1])


class Scores:
    """Scores of candidates by pool and replicate.

    `cells[candidate][pool]` is a list with, for each budget, (relMSE, energy, relMSE of the defaults), each a list of one
    number per replicate. A candidate that lacks a pool or a budget takes no part.
    """

    def __init__(self, cells, pools, energy_weight=ENERGY_WEIGHT):
        budgets = max((len(c.get(p, [])) for c in cells.values() for p in pools), default=0)
        complete = {c: by_pool for c, by_pool in cells.items()
                    if all(len(by_pool.get(p, [])) == budgets and all(all(t) for t in by_pool[p]) for p in pools)}
        self.incomplete = [c for c in cells if c not in complete]
        self.energy_weight = energy_weight
        self.cells = cells
        self._scores = {c: {p: self._of_pool(by_pool[p]) for p in pools} for c, by_pool in complete.items()}

    def _of_pool(self, budgets):
        return [average(of_budgets) for of_budgets in zip(*(self._of_cell(*cell) for cell in budgets), strict=True)]

    def _of_cell(self, error, energy, base):
        return [math.log(max(e / b, LEAST_RATIO)) + self.energy_weight * outside(light)
                for e, light, b in zip(error, energy, base, strict=True)]

    @property
    def candidates(self):
        return list(self._scores)

    def variants(self, candidate, pools):
        """The score on these pools, one of each replicate."""
        return [average(values) for values in zip(*(self._scores[candidate][p] for p in pools), strict=True)]

    def difference(self, a, b, pools):
        """Score of a less score of b and its standard error over replicates, paired."""
        parts = [x - y for x, y in zip(self.variants(a, pools), self.variants(b, pools), strict=True)]
        if not any(parts):
            return 0.0, 0.0
        return mean_and_error(parts)

    def score(self, candidate, pools):
        return average(self.variants(candidate, pools))

    def choose(self, pools):
        """The best on these pools. Level with it is what lies within one standard error of the paired difference;
        of those the one that changes the fewest defaults is taken, then the one with the lower score, then the first of
        the plan."""
        pools = list(pools)
        scores = {c: self.score(c, pools) for c in self.candidates}
        best = min(self.candidates, key=lambda c: (scores[c], c.place))
        tied = []
        for c in self.candidates:
            gap, error = self.difference(c, best, pools)
            if gap <= error:
                tied.append(c)
        chosen = min(tied, key=lambda c: (c.changes, scores[c], c.place))
        defaults = [scores[c] for c in self.candidates if c.changes == 0]
        return Choice(chosen, best, len(tied), scores[chosen], defaults[0] if defaults else math.nan)

    def leave_one_out(self, pools):
        """{pool: the choice that the other pools make}"""
        return {p: self.choose([q for q in pools if q != p]) for p in pools}
