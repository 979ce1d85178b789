#include "lib/metrics/bootstrap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/pairwise_sum.h"
#include "lib/core/random.h"

namespace spool {

BlockBootstrap::BlockBootstrap(int width, int height, const BootstrapOptions& options)
    : width_(width),
      height_(height),
      block_size_(options.block_size),
      blocks_x_((width + options.block_size - 1) / options.block_size),
      blocks_y_((height + options.block_size - 1) / options.block_size),
      resamples_(options.resamples) {
  SPOOL_CHECK_GT(width, 0);
  SPOOL_CHECK_GT(height, 0);
  SPOOL_CHECK_GT(options.block_size, 0);
  SPOOL_CHECK_GE(options.resamples, 0);
  const auto count = static_cast<std::size_t>(blocks());
  weights_.assign(static_cast<std::size_t>(resamples_) * count, 0.0);
  for (int r = 0; r < resamples_; ++r) {
    double* row = weights_.data() + static_cast<std::size_t>(r) * count;
    for (std::size_t draw = 0; draw < count; ++draw) {
      const double u = unit_double(mix(options.seed, r, draw));
      row[std::min(count - 1, static_cast<std::size_t>(u * static_cast<double>(count)))] += 1.0;
    }
  }
}

Rectangle BlockBootstrap::block_bounds(int block) const {
  const int x = block % blocks_x_ * block_size_, y = block / blocks_x_ * block_size_;
  return intersect({x, y, x + block_size_, y + block_size_}, {0, 0, width_, height_});
}

std::span<const double> BlockBootstrap::weights(int resample) const {
  const auto count = static_cast<std::size_t>(blocks());
  return {weights_.data() + static_cast<std::size_t>(resample) * count, count};
}

double weighted_sum(std::span<const double> values, std::span<const double> weights) {
  if (weights.empty()) {
    return pairwise_sum(values.size(), [&](std::size_t i) { return values[i]; });
  }
  SPOOL_CHECK_EQ(values.size(), weights.size());
  double sum = 0.0;
  for (std::size_t b = 0; b < values.size(); ++b)
    sum += weights[b] * values[b];
  return sum;
}

std::vector<double> resampled_sums(std::span<const double> values,
                                   const BlockBootstrap& bootstrap) {
  constexpr int kTogether = 8;  // sums that do not wait for each other
  std::vector<double> sums(static_cast<std::size_t>(bootstrap.resamples()));
  for (int first = 0; first < bootstrap.resamples(); first += kTogether) {
    const int count = std::min(kTogether, bootstrap.resamples() - first);
    std::array<const double*, kTogether> weights;
    for (int k = 0; k < kTogether; ++k)
      weights[static_cast<std::size_t>(k)] =
          bootstrap.weights(first + std::min(k, count - 1)).data();
    std::array<double, kTogether> together{};
    for (std::size_t b = 0; b < values.size(); ++b)
      for (std::size_t k = 0; k < kTogether; ++k)
        together[k] += weights[k][b] * values[b];
    std::copy_n(together.begin(), count, sums.begin() + first);
  }
  return sums;
}

double standard_error_of(std::span<const double> resampled) {
  double mean = 0.0, m2 = 0.0;
  int n = 0;
  for (const double value : resampled) {
    if (!std::isfinite(value)) continue;
    ++n;
    const double delta = value - mean;
    mean += delta / n;
    m2 += delta * (value - mean);
  }
  return n < 2 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(m2 / (n - 1));
}

double quotient(double n, double d) {
  if (d != 0.0) return n / d;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return n == 0.0 || std::isnan(n) ? std::numeric_limits<double>::quiet_NaN()
                                   : std::copysign(kInfinity, n);
}

bool in_several_blocks(std::span<const double> denominator) {
  return std::ranges::count_if(denominator, [](double d) { return d != 0.0; }) >= 2;
}

Estimate ratio_of_sums(const BlockBootstrap& bootstrap, std::span<const double> numerator,
                       std::span<const double> denominator) {
  const auto ratio = [&](std::span<const double> weights) {
    return quotient(weighted_sum(numerator, weights), weighted_sum(denominator, weights));
  };
  Estimate estimate;
  estimate.value = ratio({});
  if (!in_several_blocks(denominator)) return estimate;
  std::vector<double> resampled(static_cast<std::size_t>(bootstrap.resamples()));
  for (int r = 0; r < bootstrap.resamples(); ++r)
    resampled[static_cast<std::size_t>(r)] = ratio(bootstrap.weights(r));
  estimate.standard_error = standard_error_of(resampled);
  return estimate;
}

}  // namespace spool
