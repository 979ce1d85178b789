import math
import random

import pytest

from intervals import mean_interval, paired_difference, paired_ratio, student_cdf, student_quantile


@pytest.mark.parametrize("freedom, quantile", [(1, 12.706204736), (2, 4.302652730), (4, 2.776445105),
                                               (30, 2.042272456)])  # printed tables
def test_quantiles_of_student_are_those_of_the_tables(freedom, quantile):
    assert student_quantile(0.975, freedom) == pytest.approx(quantile, rel=1e-9)
    assert student_cdf(quantile, freedom) == pytest.approx(0.975, abs=1e-9)
    assert student_cdf(-quantile, freedom) == pytest.approx(0.025, abs=1e-9)


def test_interval_of_five_values_by_hand():
    interval = mean_interval([1.0, 2.0, 3.0, 4.0, 5.0])
    assert interval.mean == 3.0
    assert interval.high - 3.0 == pytest.approx(2.776445105 * math.sqrt(2.5 / 5.0), rel=1e-9)
    assert 3.0 - interval.low == pytest.approx(interval.high - 3.0)


def test_interval_of_skewed_values_solves_halls_cubic():
    # The cubic and the values of intervals_test.cpp.
    interval = mean_interval([0.0, 0.0, 0.0, 0.0, 10.0])
    g, error = 200.0 / 20.0 ** 1.5 / math.sqrt(5.0), 2.0
    for truth, quantile in ((interval.low, 2.776445105), (interval.high, -2.776445105)):
        t = (2.0 - truth) / error
        assert t + g * t * t / 3 + g * g * t ** 3 / 27 + g / 6 == pytest.approx(quantile, rel=1e-8)


def test_interval_of_three_values_is_students():
    interval = mean_interval([0.0, 0.0, 3.0])
    assert interval.high - 1.0 == pytest.approx(4.302652730, rel=1e-9)
    assert 1.0 - interval.low == pytest.approx(4.302652730, rel=1e-9)


def test_without_skewness_a_ratio_has_fiellers_interval():
    # Two groups that mirror each other: no skewness whatever the ratio.
    pairs = [(2.0 + s * u, 1.0 + s * v) for s in (1, -1) for u, v in ((0.3, 0.1), (0.1, -0.1), (0.2, 0.05))]
    n, t2 = 6, student_quantile(0.975, 5) ** 2
    aa, bb, ab = (sum((p[i] - (2.0, 1.0)[i]) * (p[j] - (2.0, 1.0)[j]) for p in pairs) / n / (n - 1)
                  for i, j in ((0, 0), (1, 1), (0, 1)))
    lead, middle = 1.0 - t2 * bb, 2.0 - t2 * ab
    root = math.sqrt(middle * middle - lead * (4.0 - t2 * aa))
    ratio = paired_ratio(pairs)
    assert ratio.low == pytest.approx((middle - root) / lead, rel=1e-8)
    assert ratio.high == pytest.approx((middle + root) / lead, rel=1e-8)


def test_a_ratio_of_zeros_is_zero():
    assert paired_ratio([(0.0, 1.0), (0.0, 2.0), (0.0, 1.5), (0.0, 1.0)])[1:] == (0.0, 0.0, 0.0)


def test_one_value_has_no_interval_and_none_has_no_mean():
    assert mean_interval([7.0]).mean == 7.0
    assert math.isnan(mean_interval([7.0, float("nan")]).low)
    assert math.isnan(mean_interval([]).mean)


def test_a_ratio_of_proportional_values_is_exact():
    ratio = paired_ratio([(2.0 * b, b) for b in (1.0, 1.2, 0.9, 1.1)])
    assert ratio.mean == pytest.approx(2.0)
    assert ratio.low == pytest.approx(2.0) and ratio.high == pytest.approx(2.0)


def test_a_ratio_to_something_that_may_be_zero_has_no_interval():
    ratio = paired_ratio([(1.0, 0.1), (1.1, -0.1), (0.9, 0.2)])
    assert math.isnan(ratio.low) and math.isnan(ratio.high)


@pytest.mark.parametrize("truth, make", [
    (0.5, lambda a, b: paired_ratio([(0.5 * x * y, x) for x, y in zip(a, b)])),
    (0.0, lambda a, b: paired_difference(list(zip(a, b)))),
])
def test_95_percent_intervals_hold_the_truth_95_times_of_100(truth, make):
    source = random.Random(7)
    trials, hits = 1000, 0
    for _ in range(trials):
        a, b = ([1.0 + 0.05 * source.gauss(0.0, 1.0) for _ in range(5)] for _ in range(2))
        interval = make(a, b)
        hits += interval.low <= truth <= interval.high
    # 4 standard deviations of a binomial: wrong once in 16000 seeds.
    assert abs(hits - 950) < 4.0 * math.sqrt(trials * 0.95 * 0.05)
