#include "lib/kernels/sample_half.h"

#include <algorithm>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

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

// Mean and variance of the samples of both halves; pooled only where a piece needs it.
Result<ChannelEstimates> estimate_both(const PieceStatistics& statistics, std::size_t channel,
                                       double exposure) {
  const auto n = statistics.n.pixels();
  if (std::all_of(n.begin(), n.end(), [](std::int32_t k) { return k >= 2; }))
    return ChannelEstimates{statistics.mean[channel],
                            Plane(statistics.width(), statistics.height())};
  GuardCounts counted_on_the_whole;
  return estimate_channel(statistics, channel, {}, exposure, counted_on_the_whole);
}

// The variance of a half's mean by the samples of both halves; of one sample, what is pooled.
Result<Plane> variance_of_both(const PieceStatistics& statistics, std::size_t channel,
                               const CountImage& n, double exposure) {
  SPOOL_ASSIGN(ChannelEstimates whole, estimate_both(statistics, channel, exposure));
  parallel_for(n.size(), [&](std::size_t i) {
    const int all = statistics.n[i];
    if (all >= 2) {
      whole.variance[i] = std::max(statistics.m2[channel][i] / (all - 1) / all,
                                   variance_floor(whole.mean[i], 1.0 / exposure));
    }
    // An empty half's mean is its neighbours', as uncertain as one sample.
    whole.variance[i] *= static_cast<double>(std::max(1, all)) / std::max(1, n[i]);
  });
  return std::move(whole.variance);
}

// Mean and variance of a channel by the half's own samples.
Result<ChannelEstimates> estimate_own(const HalfSums& half, const PieceStatistics& statistics,
                                      std::size_t channel, HalfVariance variance, double exposure) {
  PieceStatistics own;
  own.pieces_per_side = statistics.pieces_per_side;
  own.n = half.n;
  own.mean[channel] = half.mean[channel];
  own.m2[channel] = half.m2[channel];
  GuardCounts counted_on_the_whole;
  return estimate_channel(own, channel, of_own_samples(variance), exposure, counted_on_the_whole);
}

// Mean by the half's samples, variance by those of both.
Result<ChannelEstimates> estimate_of_both(const HalfSums& half, const PieceStatistics& statistics,
                                          std::size_t channel, double exposure) {
  GuardCounts counted_on_the_whole;
  SPOOL_ASSIGN(Plane variance, variance_of_both(statistics, channel, half.n, exposure));
  return ChannelEstimates{fill_empty_pieces(half.mean[channel], half.n, statistics.pieces_per_side,
                                            counted_on_the_whole),
                          std::move(variance)};
}

}  // namespace

HalfSums empty_half(int width, int height, int parity, HalfVariance variance) {
  HalfSums half{parity, CountImage(width, height), make_rgb(width, height), {}};
  if (variance != HalfVariance::kBoth) half.m2 = make_rgb(width, height);
  return half;
}

void take_up_to(const CountImage& n, const SamplePool& pool, HalfSums& half) {
  const bool own_variance = !half.m2[0].empty();
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t p = n.index(x, y);
      for (int s = half.parity + 2 * half.n[p]; s < n[p]; s += 2) {
        const Rgb radiance = pool.sample(x, y, s);
        ++half.n[p];
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = static_cast<double>(radiance[c]);
          const double delta = value - half.mean[c][p];
          half.mean[c][p] += delta / half.n[p];
          if (own_variance) half.m2[c][p] += delta * (value - half.mean[c][p]);
        }
      }
    }
  });
}

Result<SampleHalf> sample_half(const HalfSums& half, const PieceStatistics& statistics,
                               HalfVariance variance, double exposure) {
  SPOOL_TRY(check_any_sample(half.n));
  SampleHalf result{half.n, {}};
  for (std::size_t c = 0; c < 3; ++c) {
    SPOOL_ASSIGN(ChannelEstimates channel,
                 variance == HalfVariance::kBoth
                     ? estimate_of_both(half, statistics, c, exposure)
                     : estimate_own(half, statistics, c, variance, exposure));
    parallel_for(half.n.size(), [&](std::size_t i) {
      channel.mean[i] *= exposure;
      channel.variance[i] *= exposure * exposure;
    });
    result.image.mean[c] = std::move(channel.mean);
    result.image.variance[c] = std::move(channel.variance);
  }
  return result;
}

Result<SampleHalf> sample_half(const PieceStatistics& statistics, const SamplePool& pool,
                               int parity, HalfVariance variance, double exposure) {
  HalfSums half = empty_half(statistics.width(), statistics.height(), parity, variance);
  take_up_to(statistics.n, pool, half);
  return sample_half(half, statistics, variance, exposure);
}

}  // namespace spool
