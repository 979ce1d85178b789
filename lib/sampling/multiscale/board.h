// The board [LiuZheng]: the grid of pieces on which samples are placed, with the analysed scalars
// of its pieces, their pyramids, and the priority of every region. It holds; analysis.h computes.
// Images of an analysis are of T: double for update=exact, float for update=epoch.
//
// A board is the whole image, or a tile of it with its view of its neighbours. Images of a
// board have window coordinates: (0, 0) is (window.x0, window.y0) of the grid of pieces.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/pool/sample_pool.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/sampling/multiscale/options.h"
#include "lib/sampling/multiscale/samples.h"

namespace spool {

template <class T>
struct ScalarAnalysis {
  Image<T> contrast;         // C^2 of each piece
  PyramidImages<T> pyramid;  // f_0 .. f_K and d_0 .. d_{K-1}; one level more for d_index = same_k
  std::vector<Image<T>> variance;     // V_1 .. V_K at [k - 1]
  std::vector<Image<T>> attenuation;  // A_0 .. A_K
};

struct Board {
  Rectangle window;             // of the grid: what the analysis reads
  Rectangle area;               // of the window: what may be sampled; regions are clipped to it
  Image<std::uint8_t> fresh;    // samples taken in this step, at most kMostPredicted
  Image<std::uint8_t> closed;   // 1: no sample left before this step
  long long closed_pieces = 0;  // of `area`

  Rectangle bounds() const { return {0, 0, window.width(), window.height()}; }
};

template <class T>
struct AnalysedBoard : Board {
  std::vector<ScalarAnalysis<T>> scalars;
  std::vector<Image<T>> priority;  // P_1 .. P_K at [k - 1]; -infinity outside `area`
};
using ExactBoard = AnalysedBoard<double>;
using EpochBoard = AnalysedBoard<float>;  // without d and V unless they are asked for

// The pyramid that the options ask for: K levels, K + 1 for d_index = same_k.
PyramidOptions board_pyramid(const MultiscaleOptions& options);
// The detail image that level k looks at.
inline int detail_of_level(int k, const MultiscaleOptions& options) {
  return options.detail_index == DetailIndex::kProducedWithLevel ? k - 1 : k;
}

// A board of `window` that may sample `area` (both of the grid here), with the pieces as they are.
template <class T>
AnalysedBoard<T> load_board(const Samples& samples, const SamplePool& pool, const Rectangle& window,
                            const Rectangle& area, const MultiscaleOptions& options,
                            GuardCounts& guards);
// The same, with the pieces as they were when `whole`, the board of the whole grid, was loaded.
template <class T>
AnalysedBoard<T> cut_board(const AnalysedBoard<T>& whole, const Rectangle& window,
                           const Rectangle& area);

// Keeps what cut_board() needs and frees the rest.
template <class T>
void forget_analysis(AnalysedBoard<T>& board);

// Copies mean and contrast of a piece (of the window) into the board.
template <class T>
void load_piece(AnalysedBoard<T>& board, const Samples& samples, int x, int y,
                const MultiscaleOptions& options, GuardCounts& guards);

}  // namespace spool
