#include "lib/sampling/neyman.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/core/parallel_count.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

// Of all samples; 0 where all of a pixel's were rejected.
RgbImage mean_of_recording(const RecordedSamples& recording) {
  RgbImage mean = make_rgb(recording.width(), recording.height());
  parallel_rows(0, recording.height(), [&](int y) {
    for (int x = 0; x < recording.width(); ++x) {
      int count = 0;
      for (int s = 0; s < recording.spp(); ++s) {
        if (recording.rejected(x, y, s)) continue;
        ++count;
        const Rgb value = recording.radiance(x, y, s);
        for (std::size_t c = 0; c < 3; ++c)
          mean[c](x, y) += (value[c] - mean[c](x, y)) / count;
      }
    }
  });
  return mean;
}

// What every channel of a pixel's squared error is multiplied by.
RgbImage error_weights(const SamplePool& pool, NeymanTarget target) {
  constexpr double kRelativeFloor = 0.01;  // of relmse, after its relative scale
  const RecordedSamples& recording = pool.recording();
  const int width = recording.width(), height = recording.height();
  RgbImage weight = make_rgb(width, height, 1.0);
  if (target == NeymanTarget::kSquaredError) return weight;
  const RgbImage denominator =
      recording.reference() ? recording.reference()->mean : mean_of_recording(recording);
  const double sum = pairwise_sum(denominator[0].size(), [&](std::size_t i) {
    return luminance(denominator[0][i], denominator[1][i], denominator[2][i]);
  });
  // A picture without light has no relative error.
  const double scale = sum > 0.0 ? static_cast<double>(denominator[0].size()) / sum : 1.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < weight[c].size(); ++i) {
      const double d = scale * denominator[c][i];
      weight[c][i] = scale * scale / (d * d + kRelativeFloor);
    }
  }
  return weight;
}

Plane pool_variance(const SamplePool& pool, const RgbImage& weight) {
  const int q = pool.pieces_per_side();
  Plane variance(pool.width(), pool.height());
  parallel_rows(0, pool.height(), [&](int y) {
    for (int x = 0; x < pool.width(); ++x) {
      const int count = pool.size(x, y);
      std::array<double, 3> mean{}, m2{};
      for (int s = 0; s < count; ++s) {
        const Rgb value = pool.sample(x, y, s);
        for (std::size_t c = 0; c < 3; ++c) {
          const double delta = value[c] - mean[c];
          mean[c] += delta / (s + 1);
          m2[c] += delta * (value[c] - mean[c]);
        }
      }
      double sum = 0.0;
      for (std::size_t c = 0; c < 3; ++c)
        sum += weight[c](x / q, y / q) * m2[c];
      // NaN counts as no variance, and infinity as the largest there is.
      if (count > 1 && std::isgreater(sum, 0.0))
        variance(x, y) = std::min(sum / (3.0 * (count - 1)), std::numeric_limits<double>::max());
    }
  });
  return variance;
}

// Gains fall with every sample of a piece, so all above one threshold are taken; it is found among
// the positive doubles, which are ordered as their bits are.
CountImage best_counts(const Plane& variance, const CountImage& first, const SamplePool& pool,
                       long long left) {
  if (left == 0) return first;  // not every piece has a sample
  const std::vector<long long> room = room_of(first, pool);
  // Of piece i until its next sample gains less than the threshold.
  const auto more = [&](std::uint64_t threshold, std::size_t i) {
    const double gains = variance[i] / std::bit_cast<double>(threshold);  // n (n - 1) at most
    const double count = std::floor(0.5 * (1.0 + std::sqrt(1.0 + 4.0 * gains)));
    return static_cast<long long>(std::clamp(count - first[i], 0.0, static_cast<double>(room[i])));
  };
  const auto all = [&](std::uint64_t threshold) {
    return parallel_count<long long>(room.size(),
                                     [&](std::size_t i) { return more(threshold, i); });
  };
  const double largest = *std::ranges::max_element(variance.pixels());
  std::uint64_t low = 1, high = std::bit_cast<std::uint64_t>(std::max(largest, 1e-300));
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (all(middle) > left ? low : high) = middle;
  }
  CountImage n = first;
  left -= all(high);
  for (std::size_t i = 0; i < n.size(); ++i) {
    const long long sure = more(high, i);
    const long long equal = std::min(more(low, i) - sure, left);  // to the last bit
    n[i] += static_cast<std::int32_t>(sure + equal);
    left -= equal;
  }
  if (left == 0) return n;
  const CountImage rest = hand_out(Plane(n.width(), n.height()), n, pool, left);  // without gain
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] += rest[i];
  return n;
}

}  // namespace

Result<SamplingResult> sample_neyman(const SamplePool& pool, long long budget,
                                     const NeymanOptions& options, const SamplingContext& context) {
  CountImage n = initial_counts(pool, budget, options.init_spp, context.seed);
  const long long initial = count_samples(n);
  const Plane variance = pool_variance(pool, error_weights(pool, options.minimise));
  n = best_counts(variance, n, pool, std::min(budget, pool.total_capacity()) - initial);
  if (context.views != nullptr) {
    Plane deviation = variance;
    for (double& value : deviation.pixels())
      value = std::sqrt(value);
    context.views->add("deviation", deviation);
  }
  Spending spending = begin_spending(pool, budget, n);
  spending.log.initial = initial;
  SPOOL_TRY(report_progress(context, "neyman", budget, budget));
  return end_spending(std::move(spending), pool);
}

Sampler neyman_sampler() {
  using O = NeymanOptions;
  return make_value<SamplerFunction, O>(
      {.name = "neyman",
       .summary = "oracle: by the deviation of everything recorded",
       .options =
           {
               choice_option(
                   "minimise", &O::minimise,
                   {{"mse", NeymanTarget::kSquaredError}, {"relmse", NeymanTarget::kRelativeError}},
                   "the error that no other counts make smaller"),
               integer_option("init_spp", &O::init_spp, 1, 65535, "least samples of a piece"),
           },
       .views = {{"deviation", "deviation of everything recorded"}},
       .memory = {156, 2e6},
       .cost = 1.1,
       .run = sample_neyman});
}

}  // namespace spool
