#include "lib/kernels/denoised_variance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/kernels/pair_features.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr double kNormalKurtosis = 3.0;  // where all samples are equal
constexpr double kLeastPart = 0.05;      // of a variance that no slope explains

// A piece of less samples has the least that a variance can be taken of.
double least_count(std::int32_t n) {
  return std::max(static_cast<double>(n), 2.0);
}

double squared_error_of_log(double n, double m2, double m4) {
  const double kurtosis = m2 > 0.0 ? n * m4 / (m2 * m2) : kNormalKurtosis;
  const double c = n / std::max(n - kVarianceQuantile, 0.5);
  return c * c * std::max(kurtosis - (n - 3.0) / n, 1e-6) / (n - 1.0);
}

}  // namespace

SampleVariances sample_variances(const TransformedMoments& moments, const CountImage& n,
                                 int pieces_per_side) {
  const auto zeros = [&] { return make_rgb(n.width(), n.height()); };
  SampleVariances result{zeros(), zeros(), zeros()};
  GuardCounts counted_by_the_caller;
  for (std::size_t c = 0; c < 3; ++c) {
    Plane variance = variance_of_mean(n, moments.mean[c], moments.m2[c], {}, counted_by_the_caller);
    for (std::size_t i = 0; i < n.size(); ++i)
      variance[i] *= std::max(n[i], 1);  // of no sample: infinite, filled below
    variance = fill_empty_pieces(std::move(variance), n, pieces_per_side, counted_by_the_caller);
    for (std::size_t i = 0; i < n.size(); ++i) {
      const double count = least_count(n[i]);
      const double factor = count / std::max(count - kVarianceQuantile, 0.5);
      result.log[c][i] = std::log(factor * variance[i]);
      result.log_error[c][i] = squared_error_of_log(count, moments.m2[c][i], moments.m4[c][i]);
    }
    result.value[c] = std::move(variance);
  }
  return result;
}

void correct_for_slope(SampleVariances& variances, const FilmCovariance& film,
                       const CountImage& n) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < n.size(); ++i) {
      if (n[i] < 2) continue;
      double& s2 = variances.value[c][i];
      const double freedom = n[i] - 1, x = film.x[c][i] / freedom, y = film.y[c][i] / freedom;
      const double by_slope = std::max(12.0 * (x * x + y * y) - 2.0 * s2 / n[i], 0.0);
      const double left = std::max(s2 - by_slope, kLeastPart * s2);
      variances.log[c][i] += std::log(left / s2);
      s2 = left;
    }
  }
}

RgbImage denoised_variance(const SampleVariances& variances, const PairFeatures& features,
                           const Image<float>& count, const PairWindow& window) {
  PairTest test;
  test.kappa = kSymmetricTest;
  for (std::size_t c = 0; c < 3; ++c) {
    test.mean.push_back(to_float(variances.log[c]));
    test.half2.push_back(to_float(variances.log_error[c], kVarianceQuantile * kVarianceQuantile));
  }
  const RgbImage& value = variances.value;
  PairMeans means = pair_filter({&value[0], &value[1], &value[2]}, test, features, count, window);
  RgbImage result = value;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < count.size(); ++i) {
      if (means.weight[i] > 0.0) result[c][i] = means.value[c][i];
    }
  }
  return result;
}

Image<float> float_counts(const CountImage& n) {
  Image<float> count(n.width(), n.height());
  for (std::size_t i = 0; i < count.size(); ++i)
    count[i] = static_cast<float>(n[i]);
  return count;
}

}  // namespace spool
