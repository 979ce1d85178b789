// What was taken so far.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/multiscale/options.h"
#include "lib/sampling/sampler.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

// Everything that was taken, with the statistics of each analysed scalar.
struct Samples {
  PieceStatistics statistics;
  std::vector<AnalysisSignal> signals;       // per scalar; used with one channel when per channel
  std::vector<ScalarStatistics> of_channel;  // red, green, blue; empty unless per channel
  CountImage explored;  // taken uniformly after the first; empty where the options ask for none

  std::size_t scalars() const { return signals.size(); }
  const ScalarStatistics& scalar(std::size_t i) const {
    return of_channel.empty() ? statistics.analysis : of_channel[i];
  }
  double value(std::size_t i, const Rgb& radiance) const {
    if (of_channel.empty()) return signals[i].value(radiance);
    return signals[i].value({radiance[i], radiance[i], radiance[i]});
  }
};

// Statistics with the signals that the options ask for, at the given exposure.
Samples make_samples(PieceStatistics statistics, const SamplePool& pool, double exposure,
                     const MultiscaleOptions& options);

// Takes the next `count` samples of piece (x, y) of the grid.
void take(Samples& samples, const SamplePool& pool, int x, int y, int count);
// Adds the next sample of a piece, when it is known.
void add_sample(Samples& samples, std::size_t piece, const Rgb& radiance);

// The first samples of every piece, then the share that is explored uniformly; the exposure of
// everything that decides is frozen after the first. Fills log.initial and samples_of_level[0].
Samples first_samples(const SamplePool& pool, long long budget, const MultiscaleOptions& options,
                      std::uint64_t seed, SamplingLog& log);

}  // namespace spool
