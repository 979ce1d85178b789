// What the size rule looks at where not the selection's own signal decides: its samples again, by
// luminance, by the largest channel, or by red, green and blue each alone.
//
// The exposure, the limit and the map of the selection's signal hold for all of them.
#pragma once

#include <vector>

#include "lib/filters/directional/options.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

// One signal of the pieces, empty ones filled.
struct SizeChannel {
  Plane mean, variance;    // [y][x] exposed; variance of `mean`
  Plane minimum, maximum;  // [y][x] exposed extremes of the samples; +-infinity where n = 0
};

// Red, green and blue, with `exposure` in place of the signal's own.
std::vector<SizeChannel> size_channels(const PieceStatistics& statistics, const SamplePool& pool,
                                       double exposure, const VarianceOptions& variance);

// `statistics` with the signal that the option names; per_channel keeps it, as of_selection does.
PieceStatistics with_analysis_channel(PieceStatistics statistics, const SamplePool& pool,
                                      SizeChannels channels);

}  // namespace spool
