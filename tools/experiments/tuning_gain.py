"""How much a choice changes the error, with the noise of the samples."""
import math

from inference import mean_of


def percent(log_ratio):
    return f"{100 * (math.exp(log_ratio) - 1):+.1f} %"


def gain(judged, pool, chosen, defaults, budgets, column="relmse"):
    """ln of the error of the choice over that of the defaults, of each replicate: mean over budgets."""
    cells = [zip(judged.values(column, pool, *chosen, b), judged.values(column, pool, *defaults, b), strict=True)
             for b in budgets]
    return [sum(math.log(x / y) for x, y in of_budgets) / len(budgets) for of_budgets in zip(*cells, strict=True)]


def gain_text(replicates):
    """'-3.1 % (-6.0 .. -0.1)', and 1 where all of the interval is below 0, -1 above."""
    found = mean_of(replicates, positive=False)
    return (f"{percent(found.mean)} ({percent(found.low)} .. {percent(found.high)})",
            (found.high < 0) - (found.low > 0))


def pooled(gains):
    return [sum(values) / len(values) for values in zip(*gains, strict=True)]
