#include "lib/sampling/multiscale/board.h"

#include <algorithm>
#include <type_traits>

#include "lib/core/parallel.h"

namespace spool {
namespace {

template <class T>
AnalysedBoard<T> empty_board(const Rectangle& window, const Rectangle& area, std::size_t scalars) {
  AnalysedBoard<T> board;
  board.window = window;
  board.area = {area.x0 - window.x0, area.y0 - window.y0, area.x1 - window.x0, area.y1 - window.y0};
  const Image<T> blank(window.width(), window.height());
  board.closed = Image<std::uint8_t>(window.width(), window.height());
  board.scalars.resize(scalars);
  for (ScalarAnalysis<T>& scalar : board.scalars) {
    scalar.pyramid.coarse = {blank};
    scalar.contrast = blank;
  }
  return board;
}

// Squares of differences of such values, times an attenuation, stay finite in float.
constexpr double kLargestAnalysed = 1e15;

template <class T>
T analysed(double value) {
  if constexpr (std::is_same_v<T, double>) return value;
  return static_cast<T>(std::clamp(value, -kLargestAnalysed, kLargestAnalysed));
}

}  // namespace

PyramidOptions board_pyramid(const MultiscaleOptions& options) {
  PyramidOptions pyramid = options.pyramid;
  if (options.detail_index == DetailIndex::kSameK) ++pyramid.levels;
  return pyramid;
}

template <class T>
void load_piece(AnalysedBoard<T>& board, const Samples& samples, int x, int y,
                const MultiscaleOptions& options, GuardCounts& guards) {
  const PieceStatistics& statistics = samples.statistics;
  const std::size_t piece = statistics.n.index(x + board.window.x0, y + board.window.y0);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis<T>& scalar = board.scalars[i];
    const ScalarStatistics& from = samples.scalar(i);
    scalar.pyramid.coarse[0](x, y) = analysed<T>(from.mean[piece]);
    scalar.contrast(x, y) = analysed<T>(
        statistics.n[piece] < 2
            ? 0.0
            : squared_contrast(from.minimum[piece], from.maximum[piece], options.contrast, guards));
  }
}

template <class T>
AnalysedBoard<T> load_board(const Samples& samples, const SamplePool& pool, const Rectangle& window,
                            const Rectangle& area, const MultiscaleOptions& options,
                            GuardCounts& guards) {
  AnalysedBoard<T> board = empty_board<T>(window, area, samples.scalars());
  std::vector<GuardCounts> rows(static_cast<std::size_t>(window.height()));
  parallel_rows(0, window.height(), [&](int y) {
    for (int x = 0; x < window.width(); ++x)
      load_piece(board, samples, x, y, options, rows[static_cast<std::size_t>(y)]);
  });
  for (const GuardCounts& row : rows)
    guards += row;
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x) {
      const int gx = x + window.x0, gy = y + window.y0;
      if (samples.statistics.n(gx, gy) < pool.capacity(gx, gy)) continue;
      board.closed(x, y) = 1;
      ++board.closed_pieces;
    }
  }
  return board;
}

template <class T>
AnalysedBoard<T> cut_board(const AnalysedBoard<T>& whole, const Rectangle& window,
                           const Rectangle& area) {
  AnalysedBoard<T> board = empty_board<T>(window, area, whole.scalars.size());
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis<T>& scalar = board.scalars[i];
    const ScalarAnalysis<T>& from = whole.scalars[i];
    scalar.pyramid.coarse[0] = cropped(from.pyramid.coarse[0], window);
    scalar.contrast = cropped(from.contrast, window);
  }
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x) {
      board.closed(x, y) = whole.closed(x + window.x0, y + window.y0);
      board.closed_pieces += board.closed(x, y);
    }
  }
  return board;
}

template <class T>
void forget_analysis(AnalysedBoard<T>& board) {
  for (ScalarAnalysis<T>& scalar : board.scalars) {
    scalar.pyramid.coarse.resize(1);
    scalar.pyramid.detail.clear();
    scalar.variance.clear();
    scalar.attenuation.clear();
  }
  board.priority.clear();
  board.fresh = {};
}

#define SPOOL_INSTANTIATE_BOARD(T)                                                                \
  template AnalysedBoard<T> load_board(const Samples&, const SamplePool&, const Rectangle&,       \
                                       const Rectangle&, const MultiscaleOptions&, GuardCounts&); \
  template AnalysedBoard<T> cut_board(const AnalysedBoard<T>&, const Rectangle&,                  \
                                      const Rectangle&);                                          \
  template void forget_analysis(AnalysedBoard<T>&);                                               \
  template void load_piece(AnalysedBoard<T>&, const Samples&, int, int, const MultiscaleOptions&, \
                           GuardCounts&)
SPOOL_INSTANTIATE_BOARD(double);
SPOOL_INSTANTIATE_BOARD(float);
#undef SPOOL_INSTANTIATE_BOARD

}  // namespace spool
