#include <algorithm>

#include "lib/core/random.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/greedy_order.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/sampling_loop.h"

namespace spool {
namespace {

// f, d, V and A of every scalar after the pieces of this step were loaded. old_f0[i] is f_0 of
// scalar i before the step; it is used up. Level by level, so that only one old image is kept at a
// time.
void analyse_everything(Board& board, std::vector<Plane>& old_f0, const MultiscaleOptions& options,
                        GuardCounts& guards) {
  const PyramidOptions pyramid = board_pyramid(options);
  const Rectangle all = board.bounds();
  const bool attenuates = options.attenuation != AttenuationUpdate::kNone;
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    std::vector<Plane>& f = scalar.pyramid.coarse;
    Plane& old = old_f0[i];
    if (attenuates) update_attenuation(board, scalar, 0, all, old, options);
    for (int k = 0; k < pyramid.levels; ++k) {
      const auto level = static_cast<std::size_t>(k);
      coarsen_box(f[level], pyramid, k, all, old);  // eqs 1-3
      std::swap(old, f[level + 1]);
      detail_box(f[level], f[level + 1], pyramid, k, all, scalar.pyramid.detail[level]);  // eq 4
      if (k == options.levels()) continue;  // one level more for d_index = same_k
      update_variance_term(scalar, k + 1, all, options, guards);                    // eq 6
      if (attenuates) update_attenuation(board, scalar, k + 1, all, old, options);  // eqs 7, 8
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
  std::vector<Plane> old_f0(board.scalars.size());
  for (std::uint64_t epoch = 0; log.spent < budget; ++epoch) {
    const long long spent_before = log.spent;
    const long long wanted = std::min(share, budget - log.spent);
    GreedyOrder order(board, above, static_cast<std::size_t>(wanted) / 4);
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
      old_f0[i] = board.scalars[i].pyramid.coarse[0];
    take_picks(board, samples, pool, picks, options, log.guards);
    analyse_everything(board, old_f0, options, log.guards);
    end_step(board, samples, pool, picks);
    for (int k = 1; k <= options.levels(); ++k)
      update_priority(board, k, board.area, options, log.guards);  // eq 5
    if (control.report && !control.report(log.spent - spent_before)) break;
  }
  return log;
}

}  // namespace spool
