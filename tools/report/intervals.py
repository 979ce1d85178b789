"""95 % intervals of a few replicates, of paired differences and of ratios of means.

Student's distribution for means, Fieller's theorem for ratios [Fieller54]; standard library only.
"""

import math
from functools import lru_cache
from typing import NamedTuple

NAN = float("nan")


class Interval(NamedTuple):
    n: int = 0
    mean: float = NAN
    low: float = NAN
    high: float = NAN

    def excludes(self, value):
        return self.high < value or self.low > value


def _beta_fraction(x, a, b):
    """Continued fraction of the incomplete beta function, Lentz's method [DLMF, 8.17.22]."""
    tiny = 1e-300
    c, d = 1.0, 1.0 / ((1.0 - (a + b) * x / (a + 1.0)) or tiny)
    fraction = d
    for m in range(1, 10001):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for coefficient in (even, odd):
            d = 1.0 / ((1.0 + coefficient * d) or tiny)
            c = (1.0 + coefficient / c) or tiny
            fraction *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return fraction


def incomplete_beta(x, a, b):
    if x <= 0.0 or x >= 1.0:
        return 0.0 if x <= 0.0 else 1.0
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x)
                     + b * math.log1p(-x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * _beta_fraction(x, a, b) / a
    return 1.0 - front * _beta_fraction(1.0 - x, b, a) / b


def student_cdf(t, freedom):
    tail = 0.5 * incomplete_beta(freedom / (freedom + t * t), freedom / 2.0, 0.5)
    return 1.0 - tail if t > 0.0 else tail


@lru_cache(maxsize=None)
def student_quantile(probability, freedom):
    """t with P(T <= t) = probability, by bisection; probability in [0.5, 1)."""
    low, high = 0.0, 1.0
    while student_cdf(high, freedom) < probability:
        high *= 2.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if student_cdf(middle, freedom) < probability:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _moments(values):
    mean, m2 = 0.0, 0.0
    for i, value in enumerate(values, 1):
        delta = value - mean
        mean += delta / i
        m2 += delta * (value - mean)
    return mean, m2


def mean_interval(values, level=0.95):
    """Student's interval over the finite values; bounds are NaN when there are fewer than two."""
    finite = [v for v in values if math.isfinite(v)]
    if not finite:
        return Interval()
    mean, m2 = _moments(finite)
    n = len(finite)
    if n < 2:
        return Interval(n, mean)
    reach = student_quantile(0.5 + 0.5 * level, n - 1) * math.sqrt(m2 / (n - 1) / n)
    return Interval(n, mean, mean - reach, mean + reach)


def paired_difference(pairs, level=0.95):
    """Of a - b over the pairs (a, b) that are both finite."""
    return mean_interval([a - b for a, b in pairs], level)


def paired_ratio(pairs, level=0.95):
    """mean(a) / mean(b) over pairs (a, b), with Fieller's interval.

    Bounds are NaN with fewer than two pairs, and where the mean of b cannot be told from zero: the
    ratio may then be anything.
    """
    finite = [(a, b) for a, b in pairs if math.isfinite(a) and math.isfinite(b)]
    n = len(finite)
    if n == 0:
        return Interval()
    a, a2 = _moments([p[0] for p in finite])
    b, b2 = _moments([p[1] for p in finite])
    if b == 0.0:
        return Interval(n)
    if n < 2:
        return Interval(n, a / b)
    scale = n * (n - 1)
    covariance = sum((p - a) * (q - b) for p, q in finite) / scale
    t2 = student_quantile(0.5 + 0.5 * level, n - 1) ** 2
    lead = b * b - t2 * b2 / scale
    if lead <= 0.0:
        return Interval(n, a / b)
    middle = a * b - t2 * covariance
    root = middle * middle - lead * (a * a - t2 * a2 / scale)
    reach = math.sqrt(max(0.0, root))  # negative by rounding only, when lead > 0
    return Interval(n, a / b, (middle - reach) / lead, (middle + reach) / lead)
