#include "lib/inference/intervals.h"

#include <cmath>
#include <vector>

#include "lib/core/check.h"

namespace spool {
namespace {

// Continued fraction of the incomplete beta function by Lentz's method [Dlmf, 8.17.22].
double beta_fraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
  if (std::abs(d) < kTiny) d = kTiny;
  d = 1.0 / d;
  double fraction = d;
  for (int m = 1; m <= 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    for (const double coefficient : {even, odd}) {
      d = 1.0 + coefficient * d;
      c = 1.0 + coefficient / c;
      if (std::abs(d) < kTiny) d = kTiny;
      if (std::abs(c) < kTiny) c = kTiny;
      d = 1.0 / d;
      fraction *= d * c;
    }
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return fraction;
}

// Regularised incomplete beta function I_x(a, b).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(x, a, b) / a;
  return 1.0 - front * beta_fraction(1.0 - x, b, a) / b;
}

// Sample skewness, of unbiased third and second central moments.
double skewness(std::span<const double> values, double mean, double deviation) {
  if (!(deviation > 0.0)) return 0.0;
  const auto n = static_cast<double>(values.size());
  double cubes = 0.0;
  for (const double value : values) {
    const double d = (value - mean) / deviation;
    cubes += d * d * d;
  }
  return n * cubes / ((n - 1.0) * (n - 2.0));
}

// The t whose transform t + g t^2 / (3 sqrt(n)) + g^2 t^3 / (27 n) + g / (6 sqrt(n)) is
// `quantile`, g the skewness [Hall92]. 3 sqrt(n) / g * (cbrt(1 + g u) - 1) without the
// division by g, which may be zero.
double skewed_t(double quantile, double g, double n) {
  const double u = quantile / std::sqrt(n) - g / (6.0 * n);
  const double root = std::cbrt(1.0 + g * u);
  return 3.0 * u / (root * root + root + 1.0) * std::sqrt(n);
}

}  // namespace

double student_cdf(double t, double freedom) {
  SPOOL_CHECK_GT(freedom, 0.0);
  const double tail = 0.5 * incomplete_beta(freedom / (freedom + t * t), freedom / 2.0, 0.5);
  return t > 0.0 ? 1.0 - tail : tail;
}

double student_quantile(double probability, double freedom) {
  SPOOL_CHECK_GT(probability, 0.0);
  SPOOL_CHECK_LT(probability, 1.0);
  if (probability == 0.5) return 0.0;
  if (probability < 0.5) return -student_quantile(1.0 - probability, freedom);
  double low = 0.0, high = 1.0;
  while (student_cdf(high, freedom) < probability)
    high *= 2.0;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (student_cdf(middle, freedom) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Interval mean_interval(std::span<const double> values, double level) {
  constexpr int kFewestWithSkewness = 4;
  Interval interval;
  std::vector<double> finite;
  double mean = 0.0, m2 = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    finite.push_back(value);
    const double delta = value - mean;
    mean += delta / static_cast<double>(finite.size());
    m2 += delta * (value - mean);
  }
  interval.n = static_cast<int>(finite.size());
  if (interval.n == 0) return interval;
  interval.mean = mean;
  if (interval.n < 2) return interval;
  const double deviation = std::sqrt(m2 / (interval.n - 1));
  interval.standard_error = deviation / std::sqrt(interval.n);
  const double g = interval.n < kFewestWithSkewness ? 0.0 : skewness(finite, mean, deviation);
  const double quantile = student_quantile(0.5 + 0.5 * level, interval.n - 1);
  interval.low = mean - skewed_t(quantile, g, interval.n) * interval.standard_error;
  interval.high = mean - skewed_t(-quantile, g, interval.n) * interval.standard_error;
  return interval;
}

Interval paired_difference(std::span<const double> a, std::span<const double> b, double level) {
  SPOOL_CHECK_EQ(a.size(), b.size());
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i)
    differences.push_back(a[i] - b[i]);
  return mean_interval(differences, level);
}

}  // namespace spool
