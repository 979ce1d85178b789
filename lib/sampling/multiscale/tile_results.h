// What the tiles of a run leave behind, joined: attenuation, views, logs.
#pragma once

#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/board_log.h"
#include "lib/sampling/multiscale/board_views.h"
#include "lib/sampling/sampler.h"

namespace spool {

class TileResults {
 public:
  // `wanted` may be null; `options` must outlive this.
  TileResults(std::size_t tiles, const Rectangle& grid, const Views* wanted,
              const MultiscaleOptions& options);

  bool wants_level_images() const { return level_views_.wanted(); }
  // Takes what a board has become. Several threads may add boards with disjoint areas.
  template <class T>
  void add(std::size_t t, AnalysedBoard<T> board, BoardLog log);
  // Attenuation and log of the whole, and the views where there are any; `explored` as in Samples.
  void hand_over(SamplingResult& result, const CountImage& explored, Views* views);

 private:
  BoardViews views_;
  LevelViews level_views_;
  std::vector<BoardLog> logs_;
  std::vector<Plane> attenuation_;  // A_0 .. A_K of the grid
};

}  // namespace spool
