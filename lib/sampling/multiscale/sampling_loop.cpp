#include "lib/sampling/multiscale/sampling_loop.h"

namespace spool {

LoopLog make_loop_log(const Board& board, const MultiscaleOptions& options,
                      const LoopControl& control) {
  LoopLog log;
  const auto count = static_cast<std::size_t>(options.levels()) + 1;
  log.samples_of_level.assign(count, 0);
  if (control.keep_level_images) {
    log.level_of_samples.assign(count, CountImage(board.window.width(), board.window.height()));
  }
  return log;
}

void record_pop(LoopLog& log, int level, std::span<const Pick> picks) {
  const auto l = static_cast<std::size_t>(level);
  for (const Pick& pick : picks) {
    log.spent += pick.count;
    log.samples_of_level[l] += pick.count;
    if (!log.level_of_samples.empty()) log.level_of_samples[l](pick.x, pick.y) += pick.count;
  }
}

void spend_remainder(Board& board, Samples& samples, const SamplePool& pool, long long left,
                     const MultiscaleOptions& options, const LoopControl& control, LoopLog& log) {
  const Rectangle area = {board.area.x0 + board.window.x0, board.area.y0 + board.window.y0,
                          board.area.x1 + board.window.x0, board.area.y1 + board.window.y0};
  const CountImage raised =
      raise_least_sampled(samples.statistics.n, pool, area, left, control.seed);
  std::vector<Pick> picks;
  for (int y = 0; y < area.height(); ++y) {
    for (int x = 0; x < area.width(); ++x) {
      const int count = raised(x, y) - samples.statistics.n(x + area.x0, y + area.y0);
      if (count > 0) picks.push_back({x + board.area.x0, y + board.area.y0, count});
    }
  }
  take_picks(board, samples, pool, picks, options, log.guards);
  const long long before = log.spent;
  record_pop(log, 0, picks);
  end_step(board, samples, pool, picks);
  log.uniform_remainder += log.spent - before;
}

}  // namespace spool
