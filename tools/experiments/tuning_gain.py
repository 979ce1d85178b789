"""How much a choice changes the error, with the noise of the samples."""
import math

from results import T_QUANTILE, mean


def percent(log_ratio):
    return f"{100 * (math.exp(log_ratio) - 1):+.1f} %"


def gain(judged, pool, chosen, defaults, budgets, column="relmse"):
    """ln of the error of the choice over that of the defaults: mean over budgets, as a whole and without each replicate."""
    cells = [(judged.values(column, pool, *chosen, b), judged.values(column, pool, *defaults, b)) for b in budgets]
    replicates = len(cells[0][0])
    def variant(left_out):
        return mean([math.log(sum(x for r, x in enumerate(a) if r != left_out)
                              / sum(x for r, x in enumerate(b) if r != left_out)) for a, b in cells])
    return [variant(None), *(variant(r) for r in range(replicates))]


def gain_text(variants):
    """'-3.1 % (-6.0 .. -0.1)', and whether 0 is outside the interval."""
    whole, *parts = variants
    n, middle = len(parts), mean(parts)
    error = math.sqrt((n - 1) / n * sum((x - middle) ** 2 for x in parts))
    low, high = (whole + sign * T_QUANTILE[min(n - 1, max(T_QUANTILE))] * error for sign in (-1, 1))
    return f"{percent(whole)} ({percent(low)} .. {percent(high)})", (high < 0) - (low > 0)


def pooled(gains):
    return [mean(values) for values in zip(*gains, strict=True)]
