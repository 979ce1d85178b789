#include "lib/kernels/piece_estimates.h"

#include <algorithm>
#include <utility>

namespace spool {
namespace {

// Fills the empty pieces of one more image whose empty pieces are counted already.
Plane fill_uncounted(Plane pieces, const PieceStatistics& statistics) {
  GuardCounts counted_elsewhere;
  return fill_empty_pieces(std::move(pieces), statistics.n, statistics.pieces_per_side,
                           counted_elsewhere);
}

Plane scaled(const Plane& plane, double factor) {
  Plane result = plane;
  for (double& value : result.pixels())
    value *= factor;
  return result;
}

}  // namespace

Result<void> check_any_sample(const CountImage& n) {
  if (std::any_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k > 0; }))
    return {};
  return fail(ErrorCode::kData,
              "selection: no piece has a sample: raise the budget or check the counts");
}

Result<ChannelEstimates> estimate_channel(const PieceStatistics& statistics, std::size_t channel,
                                          const VarianceOptions& options, double exposure,
                                          GuardCounts& guards) {
  SPOOL_TRY(check_any_sample(statistics.n));
  const VarianceOptions of_radiance{options.mode, options.scale / exposure};
  ChannelEstimates estimates;
  estimates.mean =
      fill_empty_pieces(statistics.mean[channel], statistics.n, statistics.pieces_per_side, guards);
  estimates.variance = fill_uncounted(variance_of_mean(statistics.n, statistics.mean[channel],
                                                       statistics.m2[channel], of_radiance, guards),
                                      statistics);
  return estimates;
}

Result<PieceEstimates> estimate_pieces(const PieceStatistics& statistics,
                                       const VarianceOptions& options, double exposure,
                                       GuardCounts& guards) {
  PieceEstimates estimates;
  for (std::size_t c = 0; c < 3; ++c) {
    GuardCounts of_channel;
    SPOOL_ASSIGN(ChannelEstimates channel,
                 estimate_channel(statistics, c, options, exposure, of_channel));
    estimates.mean[c] = std::move(channel.mean);
    estimates.variance[c] = std::move(channel.variance);
    if (c == 1) guards += of_channel;  // the channels share their empty pieces: count them once
  }
  estimates.n = statistics.n;
  return estimates;
}

Result<RgbImage> estimate_means(const PieceStatistics& statistics, GuardCounts& guards) {
  SPOOL_TRY(check_any_sample(statistics.n));
  RgbImage means;
  for (std::size_t c = 0; c < 3; ++c) {
    GuardCounts of_channel;
    means[c] =
        fill_empty_pieces(statistics.mean[c], statistics.n, statistics.pieces_per_side, of_channel);
    if (c == 1) guards += of_channel;  // the channels share their empty pieces: count them once
  }
  return means;
}

double analysis_exposure(const PieceStatistics& statistics, GuardCounts& guards) {
  const double exposure = statistics.signal.exposure;
  return exposure == 1.0 ? exposure_of(statistics, guards) : exposure;
}

AnalysisEstimates estimate_analysis(const PieceStatistics& statistics,
                                    const VarianceOptions& options, bool normalise,
                                    GuardCounts& guards) {
  AnalysisEstimates estimates;
  estimates.exposure =
      normalise ? analysis_exposure(statistics, guards) : statistics.signal.exposure;
  const double factor = estimates.exposure / statistics.signal.exposure;
  Plane mean = scaled(statistics.analysis.mean, factor);
  GuardCounts of_variance;
  estimates.variance = fill_uncounted(
      variance_of_mean(statistics.n, mean, scaled(statistics.analysis.m2, factor * factor), options,
                       of_variance),
      statistics);
  estimates.mean = fill_uncounted(std::move(mean), statistics);
  return estimates;
}

Plane average_piece_variance(const Plane& pieces, int pieces_per_side) {
  const int q = pieces_per_side;
  if (q == 1) return pieces;
  Plane pixels = average_pieces(pieces, q);
  for (double& value : pixels.pixels())
    value /= q * q;
  return pixels;
}

RgbImage average_pieces(RgbImage pieces, int pieces_per_side) {
  if (pieces_per_side == 1) return pieces;
  for (Plane& plane : pieces)
    plane = average_pieces(plane, pieces_per_side);
  return pieces;
}

RgbImage average_piece_variance(RgbImage pieces, int pieces_per_side) {
  if (pieces_per_side == 1) return pieces;
  for (Plane& plane : pieces)
    plane = average_piece_variance(plane, pieces_per_side);
  return pieces;
}

}  // namespace spool
