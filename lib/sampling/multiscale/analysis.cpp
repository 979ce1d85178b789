#include "lib/sampling/multiscale/analysis.h"

#include <limits>

#include "lib/core/parallel.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/block_analysis.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/step_blocks.h"

namespace spool {

void analyse(ExactBoard& board, const MultiscaleOptions& options, bool, GuardCounts& guards) {
  const auto levels = static_cast<std::size_t>(options.levels());
  const int width = board.window.width(), height = board.window.height();
  board.fresh = Image<std::uint8_t>(width, height);
  for (ScalarAnalysis<double>& scalar : board.scalars) {
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

void analyse(EpochBoard& board, const MultiscaleOptions& options, bool all_images,
             GuardCounts& guards) {
  const auto levels = static_cast<std::size_t>(options.levels());
  const auto pyramid_levels = static_cast<std::size_t>(board_pyramid(options).levels);
  const int width = board.window.width(), height = board.window.height();
  board.fresh = Image<std::uint8_t>(width, height);
  for (ScalarAnalysis<float>& scalar : board.scalars) {
    scalar.pyramid.coarse.resize(pyramid_levels + 1, Image<float>(width, height));
    if (all_images) {
      scalar.pyramid.detail.assign(pyramid_levels, Image<float>(width, height));
      scalar.variance.assign(levels, Image<float>(width, height));
    }
    start_attenuation(scalar, board.window, options);
  }
  board.priority.assign(levels,
                        Image<float>(width, height, -std::numeric_limits<float>::infinity()));
  const BlockAnalysis analysis(board, options);
  const BlockGrid grid(board.bounds());
  std::vector<GuardCounts> caught(grid.size());
  parallel_for(grid.size(), [&](std::size_t b) {
    const Rectangle box = intersect(grid[b], board.area);
    if (box.empty()) return;
    analysis.update(box, caught[b]);
    analysis.close(box);
  });
  for (const GuardCounts& block : caught)
    guards += block;
}

}  // namespace spool
