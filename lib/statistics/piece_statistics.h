// Count, mean and squared deviations of the samples taken from each piece, one sample at a time
// [Welford62], plus the extremes of the analysis signal. What every decision and filter starts
// from.
//
// M2 is the sum of squared deviations from the mean; variance = M2 / (n - 1). Sums of squares are
// never used: with mean 1000 and sigma 0.05 a third of them give negative variances in float32.
#pragma once

#include <optional>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/analysis_signal.h"

namespace spool {

// Mean, M2 and extremes of one scalar per piece. Pieces with n = 0: mean and M2 are 0, the extremes
// +infinity (minimum) and -infinity (maximum).
struct ScalarStatistics {
  Plane mean, m2, minimum, maximum;

  ScalarStatistics() = default;
  ScalarStatistics(int width, int height);
  void add(std::size_t piece, std::int32_t n_after, double value);
  friend bool operator==(const ScalarStatistics&, const ScalarStatistics&) = default;
};

struct PieceStatistics {
  int pieces_per_side = 1;
  CountImage n;           // [y][x] samples taken
  RgbImage mean;          // [c][y][x] radiance
  RgbImage m2;            // [c][y][x]
  AnalysisSignal signal;  // what `analysis` was accumulated from
  ScalarStatistics analysis;
  // Extremes of each channel in radiance units, where a method asked for them.
  std::optional<RgbImage> channel_minimum, channel_maximum;

  int width() const { return n.width(); }
  int height() const { return n.height(); }
  friend bool operator==(const PieceStatistics&, const PieceStatistics&) = default;
};

// Statistics of n and means alone; the other planes are empty.
PieceStatistics means_of(int pieces_per_side, CountImage n, RgbImage mean);

PieceStatistics empty_statistics(const SamplePool& pool, const AnalysisSignal& signal = {},
                                 bool channel_extremes = false);

// Takes the next `count` samples of piece (x, y): the only operation that moves a cursor. The
// samples must exist: n + count <= capacity.
void take(PieceStatistics& statistics, const SamplePool& pool, int x, int y, int count = 1);

// Takes the next counts(x, y) samples of every piece, in parallel.
void take_each(PieceStatistics& statistics, const SamplePool& pool, const CountImage& counts);

// What take() does with each sample, for a caller that fetched the next one of the piece.
void add_sample(PieceStatistics& statistics, std::size_t piece, const Rgb& value);

// Takes up to `spp` samples of every piece, fewer where a piece has fewer, in parallel; returns how
// many were taken.
long long take_everywhere(PieceStatistics& statistics, const SamplePool& pool, int spp);

// The statistics of the first n(x, y) samples of every piece, n and means alone: the other planes
// are empty. `counts` must not exceed capacities.
PieceStatistics prefix_means(const SamplePool& pool, const CountImage& counts);

// The statistics of the first n(x, y) samples of every piece. `counts` must not exceed capacities.
PieceStatistics prefix_statistics(const SamplePool& pool, const CountImage& counts,
                                  const AnalysisSignal& signal = {}, bool channel_extremes = false);

// Replaces the analysis signal by reading the consumed prefixes again: the statistics of a
// selection depend on its counts and its signal alone, to the last bit, not on how they came to be.
void set_signal(PieceStatistics& statistics, const SamplePool& pool, const AnalysisSignal& signal);

// Exposure that brings the mean of the (unexposed) analysis signal to 1.
double exposure_of(const PieceStatistics& statistics, GuardCounts& guards);

// Pixel estimate: the equal-weight mean of a pixel's pieces. An empty piece takes the mean of its
// pixel's other pieces; an empty pixel the nearest non-empty piece (ring search, lowest index on
// ties); both are counted.
RgbImage pixel_means(const PieceStatistics& statistics, GuardCounts& guards);
// The same for any image of pieces (values where n > 0).
Plane pieces_to_pixels(const Plane& pieces, const CountImage& n, int pieces_per_side,
                       GuardCounts& guards);
// `pieces` with those of n = 0 filled as above.
Plane fill_empty_pieces(Plane pieces, const CountImage& n, int pieces_per_side,
                        GuardCounts& guards);
// Pixels as the means of their pieces, all of which count.
Plane average_pieces(const Plane& pieces, int pieces_per_side);

}  // namespace spool
