#include <algorithm>
#include <optional>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/greedy_order.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/sampling_loop.h"
#include "lib/sampling/multiscale/step_blocks.h"

namespace spool {
namespace {

// The analysis of a board, brought up to date after each step where the step matters, block by
// block: bit for bit the analysis of everything.
class EpochAnalysis {
 public:
  EpochAnalysis(Board& board, const MultiscaleOptions& options)
      : board_(board),
        options_(options),
        pyramid_(board_pyramid(options)),
        grid_(board.bounds()),
        reach_(step_reach(options)),
        maxima_(grid_, board) {
    for (ScalarAnalysis& scalar : board_.scalars)
      scalar.pyramid.detail.clear();  // only P needs them, a row at a time
  }

  const PriorityMaxima& maxima() const { return maxima_; }

  // Before the pieces of `picks` are loaded.
  void begin_step(std::span<const Pick> picks) {
    picks_ = picks;
    step_.emplace(board_, grid_, reach_, picks, options_);
    old_f0_.assign(board_.scalars.size(), std::vector<double>(picks.size()));
    for (std::size_t i = 0; i < board_.scalars.size(); ++i) {
      const Plane& f0 = board_.scalars[i].pyramid.coarse[0];
      for (std::size_t p = 0; p < picks.size(); ++p)
        old_f0_[i][p] = f0(picks[p].x, picks[p].y);
    }
  }

  // f, V, A and P of every scalar. A level needs the whole of the one before it: one pass each.
  void analyse(GuardCounts& guards) {
    for (std::size_t i = 0; i < board_.scalars.size(); ++i)
      update_attenuation_of_pieces(board_, board_.scalars[i], picks_, old_f0_[i], options_);
    std::vector<GuardCounts> caught(grid_.size());
    for (int k = 0; k <= pyramid_.levels; ++k) {
      parallel_for(grid_.size(), [&](std::size_t b) { analyse_level(k, b, caught[b]); });
    }
    for (const GuardCounts& block : caught)
      guards += block;
  }

  // After end_step(): no priority where every piece of a region has run out.
  void close() {
    if (board_.closed_pieces == 0) return;
    parallel_for(grid_.size(), [&](std::size_t b) {
      for (int k = 1; k <= options_.levels(); ++k)
        close_regions(board_, k, step_->priority[static_cast<std::size_t>(k)][b]);
    });
  }

  // The details again, for who wants to see them.
  void restore_details() {
    for (ScalarAnalysis& scalar : board_.scalars)
      rebuild_pyramid(scalar.pyramid, scalar.pyramid.coarse[0], pyramid_);
  }

 private:
  // P_k with d_{k-1}, then f_{k+1}, A_{k+1} and V_{k+1} of one block.
  void analyse_level(int k, std::size_t b, GuardCounts& guards) {
    for (int p = 1; p <= options_.levels(); ++p) {
      if (detail_of_level(p, options_) != k - 1) continue;
      const Rectangle& box = step_->priority[static_cast<std::size_t>(p)][b];
      compute_priority_from_coarse(board_, p, box, options_, guards);  // eqs 4, 5
      maxima_.refresh(board_, p, b, box.y0, box.y1);
    }
    if (k == pyramid_.levels) return;
    for (ScalarAnalysis& scalar : board_.scalars) {
      coarsen(scalar, k, b);                 // eqs 1-3, 7, 8
      if (k == options_.levels()) continue;  // one level more for d_index = same_k
      const auto level = static_cast<std::size_t>(k) + 1;
      update_variance_term(scalar, k + 1, step_->variance[level][b], options_, guards);  // eq 6
    }
  }

  // f_{k+1} of one block; each row of it, while the old one is still there, takes A_{k+1} along.
  void coarsen(ScalarAnalysis& scalar, int k, std::size_t b) {
    const auto level = static_cast<std::size_t>(k) + 1;
    Plane& coarse = scalar.pyramid.coarse[level];
    const Rectangle steps = k < options_.levels() ? step_->attenuation[level][b] : Rectangle{};
    const Rectangle box = unite(step_->coarse[level][b], steps);
    std::optional<AttenuationRows> attenuation;
    if (!steps.empty()) attenuation.emplace(board_, k + 1, steps, options_);
    AttenuationStep step(k + 1, options_);
    visit_coarse_rows(
        scalar.pyramid.coarse[level - 1], pyramid_, k, box, [&](int y, const double* now) {
          double* row = &coarse(box.x0, y);
          if (y >= steps.y0 && y < steps.y1 && !attenuation->changes_nothing()) {
            const int i = steps.x0 - box.x0;
            attenuation->update(y, now + i, row + i, &scalar.attenuation[level](steps.x0, y), step);
          }
          std::copy_n(now, box.width(), row);
        });
  }

  Board& board_;
  const MultiscaleOptions& options_;
  const PyramidOptions pyramid_;
  const BlockGrid grid_;
  const StepReach reach_;
  PriorityMaxima maxima_;
  std::optional<StepBlocks> step_;
  std::span<const Pick> picks_;
  std::vector<std::vector<double>> old_f0_;  // [scalar][pick]
};

}  // namespace

LoopLog run_epochs(Board& board, Samples& samples, const SamplePool& pool, long long budget,
                   const MultiscaleOptions& options, const LoopControl& control) {
  LoopLog log = make_loop_log(board, options, control);
  const long long epochs = epoch_count(options, board.area.area());
  const long long share = (budget + epochs - 1) / epochs;
  const double above = options.stop_priority.value_or(0.0);

  std::vector<Pick> picks;
  EpochAnalysis analysis(board, options);
  for (std::uint64_t epoch = 0; log.spent < budget; ++epoch) {
    const long long spent_before = log.spent;
    const long long wanted = std::min(share, budget - log.spent);
    GreedyOrder order(board, analysis.maxima(), above, static_cast<std::size_t>(wanted) / 4);
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
    sort_by_place(picks, board.bounds());
    analysis.begin_step(picks);
    take_picks(board, samples, pool, picks, options, log.guards);
    analysis.analyse(log.guards);
    end_step(board, samples, pool, picks);
    analysis.close();
    if (control.report && !control.report(log.spent - spent_before)) break;
  }
  if (control.keep_details) analysis.restore_details();
  return log;
}

}  // namespace spool
