#include "lib/statistics/transformed_moments.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"

namespace spool {
namespace {

double power(double x, double lambda) {
  if (lambda == 0.5) return std::sqrt(x);
  if (lambda == 0.25) return std::sqrt(std::sqrt(x));
  return std::pow(x, lambda);
}

}  // namespace

double transformed_sample(double x, double lambda) {
  return lambda == 1.0 ? x : (power(std::max(x, 0.0), lambda) - 1.0) / lambda;
}

TransformedMoments transformed_moments(const SamplePool& pool, const CountImage& n, double unit,
                                       double lambda, HighestMoment highest) {
  SPOOL_CHECK(lambda > 0.0);
  const auto zeros = [&] { return make_rgb(n.width(), n.height()); };
  const bool fourth = highest == HighestMoment::kFourth;
  TransformedMoments moments{zeros(), zeros(), zeros(), fourth ? zeros() : RgbImage{}};
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t p = n.index(x, y);
      for (int i = 0; i < n[p]; ++i) {
        const Rgb sample = pool.sample(x, y, i);
        for (std::size_t c = 0; c < 3; ++c) {
          double &mean = moments.mean[c][p], &m2 = moments.m2[c][p], &m3 = moments.m3[c][p];
          const double value = transformed_sample(unit * static_cast<double>(sample[c]), lambda);
          const double delta = value - mean, k = i + 1;
          const double share = delta / k, term = delta * share * i;
          if (fourth) {
            moments.m4[c][p] += term * share * share * (k * k - 3.0 * k + 3.0) +
                                6.0 * share * share * m2 - 4.0 * share * m3;
          }
          m3 += term * share * (i - 1) - 3.0 * share * m2;
          m2 += term;
          mean += share;
        }
      }
    }
  });
  return moments;
}

}  // namespace spool
