#include "lib/sampling/multiscale/tile_results.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "lib/core/parallel.h"

namespace spool {
namespace {

// A_k of a board, which loses it; the mean over the analysed scalars where there are several.
template <class T>
Plane mean_attenuation(AnalysedBoard<T>& board, std::size_t k) {
  Plane mean;
  if constexpr (std::is_same_v<T, double>) {
    mean = std::move(board.scalars[0].attenuation[k]);
  } else {
    const Image<T> attenuation = std::exchange(board.scalars[0].attenuation[k], {});
    mean = Plane(attenuation.width(), attenuation.height());
    parallel_rows(0, mean.height(),
                  [&](int y) { std::ranges::copy(attenuation.row(y), mean.row(y).begin()); });
  }
  if (board.scalars.size() == 1) return mean;
  for (std::size_t p = 0; p < mean.size(); ++p) {
    double sum = mean[p];
    for (std::size_t i = 1; i < board.scalars.size(); ++i)
      sum += board.scalars[i].attenuation[k][p];
    mean[p] = sum / static_cast<double>(board.scalars.size());
  }
  return mean;
}

}  // namespace

TileResults::TileResults(std::size_t tiles, const Rectangle& grid, const Views* wanted,
                         const MultiscaleOptions& options)
    : views_(wanted, "", grid.width(), grid.height(), options),
      level_views_(wanted, grid.width(), grid.height(), options.levels()),
      logs_(tiles),
      attenuation_(static_cast<std::size_t>(options.levels()) + 1) {
  if (tiles == 1) return;
  for (Plane& plane : attenuation_)
    plane = Plane(grid.width(), grid.height());
}

template <class T>
void TileResults::add(std::size_t t, AnalysedBoard<T> board, BoardLog log) {
  views_.paste(board);
  level_views_.paste(board, log.level_of_samples);
  board.priority.clear();
  for (ScalarAnalysis<T>& scalar : board.scalars)
    scalar.pyramid = {}, scalar.variance = {};
  for (std::size_t k = 0; k < attenuation_.size(); ++k) {
    Plane mean = mean_attenuation(board, k);
    if (logs_.size() == 1) {
      attenuation_[k] = std::move(mean);
    } else {
      paste_area(board, mean, attenuation_[k]);
    }
  }
  logs_[t] = std::move(log);
}

void TileResults::hand_over(SamplingResult& result, const CountImage& explored, Views* views) {
  for (const BoardLog& log : logs_) {
    result.log.uniform_remainder += log.uniform_remainder;
    for (std::size_t k = 0; k < log.samples_of_level.size(); ++k)
      result.log.samples_of_level[k] += log.samples_of_level[k];
    result.log.guards += log.guards;
  }
  result.selection.attenuation = std::move(attenuation_);
  if (views == nullptr) return;
  views_.hand_over(*views);
  level_views_.hand_over(explored, *views);
}

template void TileResults::add(std::size_t, AnalysedBoard<double>, BoardLog);
template void TileResults::add(std::size_t, AnalysedBoard<float>, BoardLog);

}  // namespace spool
