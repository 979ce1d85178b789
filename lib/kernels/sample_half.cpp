#include "lib/kernels/sample_half.h"

#include <algorithm>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

// Count, mean and M2 of each channel, and no more.
PieceStatistics half_of_channels(const PieceStatistics& statistics, const SamplePool& pool,
                                 int parity) {
  const int width = statistics.width(), height = statistics.height();
  PieceStatistics half;
  half.pieces_per_side = statistics.pieces_per_side;
  half.n = CountImage(width, height);
  half.mean = make_rgb(width, height);
  half.m2 = make_rgb(width, height);
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t p = statistics.n.index(x, y);
      for (int s = parity; s < statistics.n[p]; s += 2) {
        const Rgb radiance = pool.sample(x, y, s);
        ++half.n[p];
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = static_cast<double>(radiance[c]);
          const double delta = value - half.mean[c][p];
          half.mean[c][p] += delta / half.n[p];
          half.m2[c][p] += delta * (value - half.mean[c][p]);
        }
      }
    }
  });
  return half;
}

VarianceOptions of_own_samples(HalfVariance variance) {
  switch (variance) {
    case HalfVariance::kRaw:
      return {VarianceMode::kRaw};
    case HalfVariance::kPooled:
      return {VarianceMode::kPooled};
    default:
      return {VarianceMode::kAuto};
  }
}

// The variance of a half's mean by the samples of both halves; of one sample, what is pooled.
Result<Plane> variance_of_both(const PieceStatistics& statistics, std::size_t channel,
                               const CountImage& n, double exposure) {
  GuardCounts counted_on_the_whole;
  SPOOL_ASSIGN(ChannelEstimates whole,
               estimate_channel(statistics, channel, {}, exposure, counted_on_the_whole));
  for (std::size_t i = 0; i < n.size(); ++i) {
    const int all = statistics.n[i];
    if (all >= 2) {
      whole.variance[i] = std::max(statistics.m2[channel][i] / (all - 1) / all,
                                   variance_floor(whole.mean[i], 1.0 / exposure));
    }
    // An empty half's mean is its neighbours', as uncertain as one sample.
    whole.variance[i] *= static_cast<double>(std::max(1, all)) / std::max(1, n[i]);
  }
  return std::move(whole.variance);
}

}  // namespace

Result<SampleHalf> sample_half(const PieceStatistics& statistics, const SamplePool& pool,
                               int parity, HalfVariance variance, double exposure) {
  PieceStatistics half = half_of_channels(statistics, pool, parity);
  GuardCounts counted_on_the_whole;
  for (std::size_t c = 0; c < 3; ++c) {
    SPOOL_ASSIGN(ChannelEstimates channel, estimate_channel(half, c, of_own_samples(variance),
                                                            exposure, counted_on_the_whole));
    half.mean[c] = std::move(channel.mean);
    half.m2[c] = std::move(channel.variance);
    if (variance == HalfVariance::kBoth) {
      SPOOL_ASSIGN(half.m2[c], variance_of_both(statistics, c, half.n, exposure));
    }
    for (double& value : half.mean[c].pixels())
      value *= exposure;
    for (double& value : half.m2[c].pixels())
      value *= exposure * exposure;
  }
  return SampleHalf{std::move(half.n), {std::move(half.mean), std::move(half.m2)}};
}

}  // namespace spool
