#include "lib/filters/directional/size_factor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/pyramid/region_mean.h"

namespace spool {
namespace {

constexpr double kLeastFactor = 0.05, kLargestFactor = 0.30;  // of literal_clamped
constexpr double kLargestInverseFactor = 1e6;
constexpr double kGreedyGamma = 0.2;
constexpr double kLeastSamples = 1.0001;  // keeps 1 - 1/N above zero: else no size ever stops

// w of eq 9 from two values of the attenuation.
double attenuation_factor(double a_fine, double a_coarse, const FilterSizeOptions& options,
                          GuardCounts& caught) {
  const double sum = a_fine + a_coarse;
  const bool never_updated = a_fine == 1.0 && a_coarse == 1.0;
  if (!(sum > 0.0) || never_updated) {
    caught.add(Guard::kSizeFactorFallback);
    return options.factor_fallback;
  }
  const double difference = std::abs(a_fine - a_coarse);
  if (options.factor.rule == SizeFactorRule::kInverse) {
    const double w = sum / difference;
    if (w <= kLargestInverseFactor) return w;
    caught.add(Guard::kSizeFactorClamped);
    return kLargestInverseFactor;
  }
  const double w = difference / sum;
  if (options.factor.rule == SizeFactorRule::kLiteral) return w;
  if (w < kLeastFactor || w > kLargestFactor) caught.add(Guard::kSizeFactorClamped);
  return std::clamp(w, kLeastFactor, kLargestFactor);
}

}  // namespace

Plane size_factors(const FilterSizeInput& input, int k, const FilterSizeOptions& options,
                   GuardCounts& guards) {
  const int width = input.mean.width(), height = input.mean.height();
  if (options.factor.rule == SizeFactorRule::kConstant) {
    return Plane(width, height, options.factor.constant);
  }
  Plane w(width, height);
  if (options.factor.rule == SizeFactorRule::kGreedy) {
    // Samples that the comparison rests on: the piece's own, then the mean over the coarser region.
    Plane samples(width, height);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = input.n[i];
    if (k > 0) samples = region_mean(samples, k + 1);
    const double scale = (k > 0 ? 5.0 / 3.0 : 1.0) * greedy_caution(kGreedyGamma);
    for (std::size_t i = 0; i < samples.size(); ++i)
      w[i] = scale * (1.0 - 1.0 / std::max(samples[i], kLeastSamples));
    return w;
  }
  if (static_cast<int>(input.attenuation.size()) <= k + 1) {
    guards.add(Guard::kSizeFactorFallback, w.size());
    return Plane(width, height, 0.10);  // a bare selection: no attenuation was ever defined
  }
  const std::size_t fine = k == 0 && !options.track_a0 ? 1 : static_cast<std::size_t>(k);
  const Plane& a_fine = input.attenuation[fine];
  const Plane& a_coarse = input.attenuation[static_cast<std::size_t>(k) + 1];
  std::vector<GuardCounts> rows(static_cast<std::size_t>(height));
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      w(x, y) = attenuation_factor(a_fine(x, y), a_coarse(x, y), options,
                                   rows[static_cast<std::size_t>(y)]);
    }
  });
  for (const GuardCounts& row : rows)
    guards += row;
  return w;
}

double greedy_caution(double gamma) {
  return -std::log(1.0 - std::pow(1.9 * gamma, 1.0 / std::sqrt(2.0)));
}

}  // namespace spool
