#include "lib/sampling/multiscale/samples.h"

#include <algorithm>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

enum Lane : std::uint64_t { kInitialLane = 1, kExploreLane = 2 };

ScalarStatistics scalar_statistics(const Samples& samples, const SamplePool& pool, std::size_t i) {
  const CountImage& n = samples.statistics.n;
  ScalarStatistics result(n.width(), n.height());
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      for (int s = 0; s < n(x, y); ++s)
        result.add(n.index(x, y), s + 1, samples.value(i, pool.sample(x, y, s)));
    }
  });
  return result;
}

}  // namespace

Samples make_samples(PieceStatistics statistics, const SamplePool& pool, double exposure,
                     const MultiscaleOptions& options) {
  Samples samples;
  samples.statistics = std::move(statistics);
  AnalysisSignal signal;
  signal.exposure = exposure;
  if (options.channels == AnalysedChannels::kMaxRgb) signal.channel = AnalysisChannel::kMaxRgb;
  set_signal(samples.statistics, pool, signal);
  if (options.channels != AnalysedChannels::kPerChannel) {
    samples.signals = {signal};
    return samples;
  }
  // The largest of three equal channels is that channel, to the last bit.
  AnalysisSignal one_channel = signal;
  one_channel.channel = AnalysisChannel::kMaxRgb;
  samples.signals.assign(3, one_channel);
  samples.of_channel.resize(3);
  for (std::size_t c = 0; c < 3; ++c)
    samples.of_channel[c] = scalar_statistics(samples, pool, c);
  return samples;
}

void take(Samples& samples, const SamplePool& pool, int x, int y, int count) {
  const std::size_t piece = samples.statistics.n.index(x, y);
  SPOOL_CHECK_LE(samples.statistics.n[piece] + count, pool.capacity(x, y));
  for (int i = 0; i < count; ++i)
    add_sample(samples, piece, pool.sample(x, y, samples.statistics.n[piece]));
}

void add_sample(Samples& samples, std::size_t piece, const Rgb& radiance) {
  add_sample(samples.statistics, piece, radiance);
  for (std::size_t c = 0; c < samples.of_channel.size(); ++c)
    samples.of_channel[c].add(piece, samples.statistics.n[piece], samples.value(c, radiance));
}

Samples first_samples(const SamplePool& pool, long long budget, const MultiscaleOptions& options,
                      std::uint64_t seed, SamplingLog& log) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  PieceStatistics first =
      prefix_statistics(pool, initial_counts(pool, budget, each, mix(seed, kInitialLane)));
  log.initial = count_samples(first.n);
  const double exposure =
      options.exposure == ExposureMode::kNormalise ? exposure_of(first, log.guards) : 1.0;
  const long long left = std::min(budget, pool.total_capacity()) - log.initial;
  const auto explored =
      static_cast<long long>(options.explore_fraction * static_cast<double>(left));
  CountImage of_piece;
  if (explored > 0) {
    of_piece = first.n;
    first = prefix_statistics(pool, raise_least_sampled(first.n, pool, first.n.bounds(), explored,
                                                        mix(seed, kExploreLane)));
    for (std::size_t i = 0; i < of_piece.size(); ++i)
      of_piece[i] = first.n[i] - of_piece[i];
    log.samples_of_level[0] += explored;
  }
  Samples samples = make_samples(std::move(first), pool, exposure, options);
  samples.explored = std::move(of_piece);
  return samples;
}

}  // namespace spool
