#include <algorithm>

#include "lib/core/random.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/greedy_order.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/sampling_loop.h"

namespace spool {
namespace {

// Keeps f_0 and hands f_1, f_2 .. over: the analysis after the step writes them anew.
void remember_coarse(Pyramid& pyramid, std::vector<Plane>& before) {
  before.resize(pyramid.coarse.size());
  before[0] = pyramid.coarse[0];
  for (std::size_t k = 1; k < before.size(); ++k)
    std::swap(before[k], pyramid.coarse[k]);
}

// f, d, V and A of every scalar after the pieces of this step were loaded; before[i][k] is f_k of
// scalar i before the step.
void analyse_everything(Board& board, const std::vector<std::vector<Plane>>& before,
                        const MultiscaleOptions& options, GuardCounts& guards) {
  const PyramidOptions pyramid = board_pyramid(options);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    rebuild_pyramid(scalar.pyramid, scalar.pyramid.coarse[0], pyramid);  // eqs 1-4
    for (int k = 0; k <= options.levels(); ++k) {
      const auto level = static_cast<std::size_t>(k);
      if (k > 0) update_variance_term(scalar, k, board.bounds(), options, guards);  // eq 6
      const Rectangle box =
          options.attenuation == AttenuationUpdate::kNone ? Rectangle{} : board.bounds();
      update_attenuation(board, scalar, k, box, before[i][level], options);  // eqs 7, 8
    }
  }
}

}  // namespace

LoopLog run_epochs(Board& board, Samples& samples, const SamplePool& pool, long long budget,
                   const MultiscaleOptions& options, const LoopControl& control) {
  LoopLog log = make_loop_log(board, options, control);
  const long long epochs = epoch_count(options, board.area.area());
  const long long share = (budget + epochs - 1) / epochs;
  const double above = options.stop_priority.value_or(0.0);

  std::vector<Pick> picks;
  std::vector<std::vector<Plane>> before(board.scalars.size());  // f_k before the step
  for (std::uint64_t epoch = 0; log.spent < budget; ++epoch) {
    const long long spent_before = log.spent;
    const long long wanted = std::min(share, budget - log.spent);
    GreedyOrder order(board, above, static_cast<std::size_t>(wanted));
    picks.clear();
    while (log.spent - spent_before < wanted) {
      const RegionEntry entry = order.next();
      if (entry.level == 0) break;
      order.take(entry);
      const std::size_t first = picks.size();
      choose_pieces(board, samples, pool, sampled_region(board, entry), budget - log.spent,
                    mix(control.seed, epoch, entry.level, entry.x, entry.y), options, picks);
      record_pop(log, entry.level, std::span(picks).subspan(first));
    }
    if (picks.empty()) {
      const bool all_saturated = board.closed_pieces == board.area.area();
      if (!options.stop_priority && !all_saturated) {
        spend_remainder(board, samples, pool, budget - log.spent, options, control, log);
      }
      break;
    }
    for (std::size_t i = 0; i < board.scalars.size(); ++i)
      remember_coarse(board.scalars[i].pyramid, before[i]);
    take_picks(board, samples, pool, picks, options, log.guards);
    analyse_everything(board, before, options, log.guards);
    end_step(board, samples, pool, picks);
    for (int k = 1; k <= options.levels(); ++k)
      update_priority(board, k, board.area, options, log.guards);  // eq 5
    if (control.report && !control.report(log.spent - spent_before)) break;
  }
  return log;
}

}  // namespace spool
