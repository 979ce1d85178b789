// Slow twin of StatER: lib/kernels/denoised_variance.h and lib/filters/welch/stater.h, for one
// piece per pixel with at least 4 samples each.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/reference/welch_reference.h"

namespace spool::reference {

struct StaterCase {
  double unit = 1.0, lambda = 1.0;
  bool slope = false, cascade = true;
  PairFeatures features;
  PairWindow window;
};

inline double box_cox(double x, double lambda) {
  return lambda == 1.0 ? x : (std::pow(std::max(x, 0.0), lambda) - 1) / lambda;
}

// Variance of one channel's samples at a pixel, less what a plane explains, and ln(c s^2), e^2.
inline std::array<double, 3> stater_variance(const SamplePool& pool, int n, int x, int y,
                                             std::size_t c, const StaterCase& at) {
  std::vector<double> t;
  double mean = 0.0;
  for (int i = 0; i < n; ++i) {
    t.push_back(box_cox(at.unit * static_cast<double>(pool.sample(x, y, i)[c]), at.lambda));
    mean += t.back() / n;
  }
  double second = 0.0, fourth = 0.0, right = 0.0, down = 0.0;
  for (int i = 0; i < n; ++i) {
    const double d = t[static_cast<std::size_t>(i)] - mean;
    second += d * d;
    fourth += d * d * d * d;
    right += d * (static_cast<double>(pool.film(x, y, i).x) - 0.5) / (n - 1);
    down += d * (static_cast<double>(pool.film(x, y, i).y) - 0.5) / (n - 1);
  }
  double s2 = second / (n - 1);
  if (at.slope) {
    const double explained = 12 * (right * right + down * down) - 2 * s2 / n;
    if (explained > 0) s2 = std::max(s2 - explained, s2 / 20);
  }
  const double factor = n / (n - 2.80703);
  const double kurtosis = n * fourth / (second * second);
  return {s2, std::log(factor * s2),
          factor * factor * std::max(kurtosis - (n - 3.0) / n, 1e-6) / (n - 1)};
}

// [c][y][x], averaged over the pixels of like variance.
inline RgbImage stater_variances(const SamplePool& pool, const CountImage& n,
                                 const StaterCase& at) {
  RgbImage value = make_rgb(n.width(), n.height());
  PairTest test;
  test.kappa = 1e20;
  test.mean.assign(3, Image<float>(n.width(), n.height()));
  test.half2 = test.mean;
  Image<float> count(n.width(), n.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      count(x, y) = static_cast<float>(n(x, y));
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [s2, log, error] = stater_variance(pool, n(x, y), x, y, c, at);
        value[c](x, y) = s2;
        test.mean[c](x, y) = static_cast<float>(log);
        test.half2[c](x, y) = static_cast<float>(2.80703 * 2.80703 * error);
      }
    }
  }
  if (!at.cascade) return value;
  const PairMeans means = reference::pair_filter({&value[0], &value[1], &value[2]}, test,
                                                 at.features, count, at.window);
  return {means.value[0], means.value[1], means.value[2]};
}

// The image: `cases` are the transforms, `t` the quantile of a number of degrees of freedom.
template <class Quantile>
RgbImage stater(const SamplePool& pool, const CountImage& n, const std::vector<StaterCase>& cases,
                Quantile t) {
  PairTest test;
  test.kappa = 1e20;
  RgbImage plain = make_rgb(n.width(), n.height());
  Image<float> count(n.width(), n.height());
  for (const StaterCase& at : cases) {
    const RgbImage variance = stater_variances(pool, n, at);
    for (std::size_t c = 0; c < 3; ++c) {
      Image<float> mean(n.width(), n.height()), half2(mean);
      for (int y = 0; y < n.height(); ++y) {
        for (int x = 0; x < n.width(); ++x) {
          const int k = n(x, y);
          double sum = 0.0, radiance = 0.0;
          for (int i = 0; i < k; ++i) {
            const auto value = static_cast<double>(pool.sample(x, y, i)[c]);
            radiance += value / k;
            sum += box_cox(at.unit * value, at.lambda) / k;
          }
          plain[c](x, y) = radiance;
          count(x, y) = static_cast<float>(k);
          mean(x, y) = static_cast<float>(sum);
          half2(x, y) = static_cast<float>(
              std::pow(t(2.0 * k - 2), 2) * variance[c](x, y) / k * (1 + 1e-6) + 1e-12);
        }
      }
      test.mean.push_back(mean);
      test.half2.push_back(half2);
    }
  }
  const PairMeans means = reference::pair_filter({&plain[0], &plain[1], &plain[2]}, test,
                                                 cases[0].features, count, cases[0].window);
  return {means.value[0], means.value[1], means.value[2]};
}

}  // namespace spool::reference
