"""95 % intervals of a few replicates, of paired differences and of ratios of means.

Student's distribution with the skewness of the values taken into account [Hall92]; a ratio's interval
holds every ratio r at which a - r b has a mean that may be zero, as Fieller's does [Fieller54].
Standard library only; the same figures as lib/inference/intervals.h.
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


FEWEST_WITH_SKEWNESS = 4  # of fewer values it says nothing


class _Moments(NamedTuple):
    n: int
    mean: float
    deviation: float
    skewness: float  # of unbiased third and second central moments


def _moments(values):
    """Of at least two values."""
    mean, m2 = 0.0, 0.0
    for i, value in enumerate(values, 1):
        delta = value - mean
        mean += delta / i
        m2 += delta * (value - mean)
    n = len(values)
    deviation = math.sqrt(m2 / (n - 1))
    skewness = 0.0
    if n >= FEWEST_WITH_SKEWNESS and deviation > 0.0:
        skewness = n * sum(((v - mean) / deviation) ** 3 for v in values) / ((n - 1) * (n - 2))
    return _Moments(n, mean, deviation, skewness)


def _unskewed(t, of):
    """Student's t of skewed values, made nearly Student's again [Hall92]."""
    g = of.skewness / math.sqrt(of.n)
    return t + g * t * t / 3.0 + g * g * t ** 3 / 27.0 + g / 6.0


def _skewed(quantile, of):
    """The t with _unskewed(t) = quantile."""
    g = of.skewness / math.sqrt(of.n)
    u = quantile - g / 6.0
    root = math.copysign(abs(1.0 + g * u) ** (1.0 / 3.0), 1.0 + g * u)
    return 3.0 * u / (root * root + root + 1.0)


def mean_interval(values, level=0.95):
    """Over the finite values; bounds are NaN when there are fewer than two."""
    finite = [v for v in values if math.isfinite(v)]
    if not finite:
        return Interval()
    if len(finite) < 2:
        return Interval(1, finite[0])
    of = _moments(finite)
    quantile = student_quantile(0.5 + 0.5 * level, of.n - 1)
    error = of.deviation / math.sqrt(of.n)
    return Interval(of.n, of.mean, of.mean - _skewed(quantile, of) * error, of.mean - _skewed(-quantile, of) * error)


def paired_difference(pairs, level=0.95):
    """Of a - b over the pairs (a, b) that are both finite."""
    return mean_interval([a - b for a, b in pairs], level)


def paired_ratio(pairs, level=0.95):
    """mean(a) / mean(b) over pairs (a, b).

    Bounds are NaN with fewer than two pairs, and where the mean of b cannot be told from zero: the
    ratio may then be anything.
    """
    finite = [(a, b) for a, b in pairs if math.isfinite(a) and math.isfinite(b)]
    n = len(finite)
    if n == 0:
        return Interval()
    a, b = ([p[k] for p in finite] for k in (0, 1))
    if sum(b) == 0.0:
        return Interval(n)
    ratio = sum(a) / sum(b)
    below = mean_interval(b, level)
    if not below.excludes(0.0):
        return Interval(n, ratio)
    quantile = student_quantile(0.5 + 0.5 * level, n - 1)

    def may_be(r):
        of = _moments([p - r * q for p, q in finite])
        if of.deviation == 0.0:
            return of.mean == 0.0
        return abs(_unskewed(of.mean / of.deviation * math.sqrt(n), of)) <= quantile

    # As the mean of b is not zero, far enough away no ratio may be.
    step = _moments([p - ratio * q for p, q in finite]).deviation / abs(below.mean)
    if step == 0.0:
        return Interval(n, ratio, ratio, ratio)
    return Interval(n, ratio, _last_true(may_be, ratio, -step), _last_true(may_be, ratio, step))


def _last_true(condition, start, step):
    """Where `condition`, true at start, ends in the direction of step; to 1e-9 of the way."""
    while condition(start + step):
        step *= 2.0
    inside, outside = 0.0, step
    while abs(outside - inside) > 1e-9 * abs(outside):
        middle = 0.5 * (inside + outside)
        if middle in (inside, outside):
            break
        if condition(start + middle):
            inside = middle
        else:
            outside = middle
    return start + inside
