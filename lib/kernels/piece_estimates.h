// What every filter starts from: the mean of each piece, with empty pieces filled, and the
// variance of that mean, per channel and for the analysis signal.
//
// An empty piece takes its neighbours' mean and variance (piece_statistics.h); it is counted once,
// and `n` still says 0, so that filters can leave it out of their sums.
#pragma once

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/statistics/selection.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

struct PieceEstimates {
  CountImage n;       // [y][x]
  RgbImage mean;      // [c][y][x] radiance
  RgbImage variance;  // [c][y][x] of `mean`, finite
};

struct ChannelEstimates {
  Plane mean, variance;  // as above
};

// Error kData when no piece has a sample.
Result<void> check_any_sample(const CountImage& n);

// The same error. `exposure` brings radiance to the scale of the variance's
// floor (VarianceOptions::scale).
Result<PieceEstimates> estimate_pieces(const PieceStatistics& statistics,
                                       const VarianceOptions& options, double exposure,
                                       GuardCounts& guards);
// The means alone.
Result<RgbImage> estimate_means(const PieceStatistics& statistics, GuardCounts& guards);
// Of one channel; counts its empty pieces, which all channels share.
Result<ChannelEstimates> estimate_channel(const PieceStatistics& statistics, std::size_t channel,
                                          const VarianceOptions& options, double exposure,
                                          GuardCounts& guards);

struct AnalysisEstimates {
  double exposure = 1.0;  // analysis value of one unit of radiance
  Plane mean;             // [y][x] exposed
  Plane variance;         // [y][x] of `mean`, finite
};

// Estimates of the analysis signal. With `normalise`, a signal without exposure (exposure 1, the
// mark of a bare selection) is brought to mean 1 first; a sampler's own exposure is kept.
AnalysisEstimates estimate_analysis(const PieceStatistics& statistics,
                                    const VarianceOptions& options, bool normalise,
                                    GuardCounts& guards);

// Exposure of the statistics' signal by the rule above.
double analysis_exposure(const PieceStatistics& statistics, GuardCounts& guards);

// Pixels from pieces, as average_pieces() of one plane (piece_statistics.h); variances are also
// divided by q^2.
RgbImage average_pieces(RgbImage pieces, int pieces_per_side);
Plane average_piece_variance(const Plane& pieces, int pieces_per_side);
RgbImage average_piece_variance(RgbImage pieces, int pieces_per_side);

}  // namespace spool
