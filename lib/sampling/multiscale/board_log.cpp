#include "lib/sampling/multiscale/board_log.h"

namespace spool {

BoardLog make_board_log(const Board& board, const MultiscaleOptions& options,
                        bool keep_level_images) {
  BoardLog log;
  const auto count = static_cast<std::size_t>(options.levels()) + 1;
  log.samples_of_level.assign(count, 0);
  if (keep_level_images)
    log.level_of_samples.assign(count, CountImage(board.window.width(), board.window.height()));
  return log;
}

void record_samples(BoardLog& log, int level, long long count) {
  log.spent += count;
  log.samples_of_level[static_cast<std::size_t>(level)] += count;
}

void record_region(BoardLog& log, int level, std::span<const Pick> picks) {
  const auto l = static_cast<std::size_t>(level);
  for (const Pick& pick : picks) {
    record_samples(log, level, pick.count);
    if (!log.level_of_samples.empty()) log.level_of_samples[l](pick.x, pick.y) += pick.count;
  }
}

}  // namespace spool
