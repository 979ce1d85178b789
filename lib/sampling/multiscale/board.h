// What one run of the sampling loop knows: the analysed scalars of its pieces, their pyramids, and
// the priority of every region.
//
// A board is the whole image, or a tile of it with what it sees of its neighbours. Images of a
// board have window coordinates: (0, 0) is (window.x0, window.y0) of the grid of pieces.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/pool/sample_pool.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/sampling/multiscale/options.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

// Everything that was taken, with the statistics of each analysed scalar.
struct Samples {
  PieceStatistics statistics;
  std::vector<AnalysisSignal> signals;       // per scalar; used with one channel when per channel
  std::vector<ScalarStatistics> of_channel;  // red, green, blue; empty unless per channel

  std::size_t scalars() const { return signals.size(); }
  const ScalarStatistics& scalar(std::size_t i) const {
    return of_channel.empty() ? statistics.analysis : of_channel[i];
  }
  double value(std::size_t i, const Rgb& radiance) const {
    if (of_channel.empty()) return signals[i].value(radiance);
    return signals[i].value({radiance[i], radiance[i], radiance[i]});
  }
};

// Statistics of `counts` with the signals that the options ask for, at the given exposure.
Samples make_samples(PieceStatistics statistics, const SamplePool& pool, double exposure,
                     const MultiscaleOptions& options);

// Takes the next `count` samples of piece (x, y) of the grid.
void take(Samples& samples, const SamplePool& pool, int x, int y, int count);
// Adds the next sample of a piece, when it is known.
void add_sample(Samples& samples, std::size_t piece, const Rgb& radiance);

// Means of scalar i over all but the last sample taken from each piece.
Plane means_before_last(const Samples& samples, const SamplePool& pool, std::size_t i);

struct ScalarAnalysis {
  Plane contrast;         // C^2 of each piece
  Plane lowest, highest;  // extremes of each piece, only for V_mode = region_minmax
  Pyramid pyramid;        // f_0 .. f_K and d_0 .. d_{K-1}; one level more for d_index = same_k
  std::vector<Plane> variance;     // V_1 .. V_K at [k - 1]
  std::vector<Plane> attenuation;  // A_0 .. A_K
};

struct Board {
  Rectangle window;  // of the grid: what the analysis reads
  Rectangle area;    // of the window: what may be sampled; regions are clipped to it
  std::vector<ScalarAnalysis> scalars;
  std::vector<Plane> priority;  // P_1 .. P_K at [k - 1]; -infinity outside `area`
  CountImage fresh;             // samples taken in this step
  Image<std::uint8_t> closed;   // 1: no sample left before this step
  long long closed_pieces = 0;  // of `area`

  Rectangle bounds() const { return {0, 0, window.width(), window.height()}; }
};

// The pyramid that the options ask for: K levels, K + 1 for d_index = same_k.
PyramidOptions board_pyramid(const MultiscaleOptions& options);
// The detail image that level k looks at.
inline int detail_of_level(int k, const MultiscaleOptions& options) {
  return options.detail_index == DetailIndex::kProducedWithLevel ? k - 1 : k;
}

// A board of `window` that may sample `area` (both of the grid here), with the pieces as they are.
Board load_board(const Samples& samples, const SamplePool& pool, const Rectangle& window,
                 const Rectangle& area, const MultiscaleOptions& options, GuardCounts& guards);
// The same, with the pieces as they were when `whole`, the board of the whole grid, was loaded.
Board cut_board(const Board& whole, const Rectangle& window, const Rectangle& area,
                const MultiscaleOptions& options);

// Analyses loaded pieces before the first step (eqs 1-6): f, d, V, A at its start, P.
// `before_last`: per scalar, means_before_last, for A_init = split; else empty.
void analyse(Board& board, const std::vector<Plane>& before_last, const MultiscaleOptions& options,
             GuardCounts& guards);
// Keeps what cut_board() needs and frees the rest.
void forget_analysis(Board& board);

// Copies mean, contrast and extremes of a piece (of the window) into the board.
void load_piece(Board& board, const Samples& samples, int x, int y,
                const MultiscaleOptions& options, GuardCounts& guards);

// Pieces whose statistics can change an analysis of `area`: area, grown by the reach of the
// filters, its corner on the lattice of the coarsest level.
Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options);

}  // namespace spool
