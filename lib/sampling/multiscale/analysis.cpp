#include "lib/sampling/multiscale/analysis.h"

#include <limits>

#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/priority.h"

namespace spool {

void analyse(Board& board, const MultiscaleOptions& options, GuardCounts& guards) {
  const auto levels = static_cast<std::size_t>(options.levels());
  const int width = board.window.width(), height = board.window.height();
  board.fresh = CountImage(width, height);
  for (ScalarAnalysis& scalar : board.scalars) {
    // Coarse and detail images [LiuZheng (1)-(4)]
    rebuild_pyramid(scalar.pyramid, scalar.pyramid.coarse[0], board_pyramid(options));
    // Contrast of every region [LiuZheng (6)]
    scalar.variance.assign(levels, Plane(width, height));
    for (int k = 1; k <= options.levels(); ++k)
      update_variance_term(scalar, k, board.bounds());
    // Nothing has changed yet [LiuZheng (7)]
    start_attenuation(scalar, board.window, options);
  }
  // Priority of every region [LiuZheng (5)]
  board.priority.assign(levels, Plane(width, height, -std::numeric_limits<double>::infinity()));
  for (int k = 1; k <= options.levels(); ++k)
    update_priority(board, k, board.area, options, guards);
}

}  // namespace spool
