#include "lib/sampling/neyman.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
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

Plane pool_deviation(const SamplePool& pool, const RgbImage& weight) {
  const int q = pool.pieces_per_side();
  Plane deviation(pool.width(), pool.height());
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
      if (count > 1) deviation(x, y) = std::sqrt(sum / (3.0 * (count - 1)));
    }
  });
  return deviation;
}

}  // namespace

Result<SamplingResult> sample_neyman(const SamplePool& pool, long long budget,
                                     const NeymanOptions& options, const SamplingContext& context) {
  CountImage n = initial_counts(pool, budget, options.init_spp, context.seed);
  const long long initial = count_samples(n);
  const Plane deviation = pool_deviation(pool, error_weights(pool, options.minimise));
  const CountImage none(pool.width(), pool.height());
  const CountImage ideal = hand_out(deviation, none, pool, budget);
  Plane missing(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i)
    missing[i] = std::max(ideal[i] - n[i], 0);
  const long long left = std::min(budget, pool.total_capacity()) - initial;
  const CountImage extra = hand_out(missing, n, pool, left);
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] += extra[i];
  if (context.views != nullptr) context.views->add("deviation", deviation);
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
