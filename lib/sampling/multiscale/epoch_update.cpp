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

Plane copy_box(const Plane& image, const Rectangle& box) {
  Plane copy(box.width(), box.height());
  for (int y = 0; y < copy.height(); ++y)
    std::copy_n(&image(box.x0, box.y0 + y), copy.width(), copy.row(y).begin());
  return copy;
}

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
        maxima_(grid_, board) {}

  const PriorityMaxima& maxima() const { return maxima_; }

  // Before the pieces of `picks` are loaded.
  void begin_step(std::span<const Pick> picks) {
    step_.emplace(board_, grid_, reach_, picks, options_);
    old_f0_.assign(board_.scalars.size(), std::vector<Plane>(grid_.size()));
    for (std::size_t i = 0; i < board_.scalars.size(); ++i) {
      for (std::size_t b = 0; b < grid_.size(); ++b) {
        const Rectangle& box = step_->attenuation[0][b];
        if (!box.empty()) old_f0_[i][b] = copy_box(board_.scalars[i].pyramid.coarse[0], box);
      }
    }
  }

  // f, d, V, A and P of every scalar. A level needs the whole of the one before it: one pass each.
  void analyse(GuardCounts& guards) {
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

 private:
  // d_{k-1}, P_k, then f_{k+1}, V_{k+1} and A_{k+1} of one block.
  void analyse_level(int k, std::size_t b, GuardCounts& guards) {
    const auto level = static_cast<std::size_t>(k);
    for (std::size_t i = 0; i < board_.scalars.size(); ++i) {
      ScalarAnalysis& scalar = board_.scalars[i];
      std::vector<Plane>& f = scalar.pyramid.coarse;
      if (k == 0) {
        update_attenuation(board_, scalar, 0, step_->attenuation[0][b], old_f0_[i][b], options_);
      } else {
        detail_box(f[level - 1], f[level], pyramid_, k - 1, step_->detail[level - 1][b],
                   scalar.pyramid.detail[level - 1]);  // eq 4
      }
      if (k == pyramid_.levels) continue;
      const bool attenuates = k < options_.levels();  // one level more for d_index = same_k
      const Rectangle box = attenuates ? step_->attenuation[level + 1][b] : Rectangle{};
      const Plane before = copy_box(f[level + 1], box);
      coarsen_box(f[level], pyramid_, k, step_->coarse[level + 1][b], f[level + 1]);  // eqs 1-3
      if (!attenuates) continue;
      update_variance_term(scalar, k + 1, step_->variance[level + 1][b], options_, guards);  // eq 6
      update_attenuation(board_, scalar, k + 1, box, before, options_);  // eqs 7, 8
    }
    for (int p = 1; p <= options_.levels(); ++p) {
      if (detail_of_level(p, options_) != k - 1) continue;
      compute_priority(board_, p, step_->priority[static_cast<std::size_t>(p)][b], options_,
                       guards);  // eq 5
      maxima_.refresh(board_, p, b);
    }
  }

  Board& board_;
  const MultiscaleOptions& options_;
  const PyramidOptions pyramid_;
  const BlockGrid grid_;
  const StepReach reach_;
  PriorityMaxima maxima_;
  std::optional<StepBlocks> step_;
  std::vector<std::vector<Plane>> old_f0_;  // [scalar][block]: f_0 on the block's attenuation box
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
    analysis.begin_step(picks);
    take_picks(board, samples, pool, picks, options, log.guards);
    analysis.analyse(log.guards);
    end_step(board, samples, pool, picks);
    analysis.close();
    if (control.report && !control.report(log.spent - spent_before)) break;
  }
  return log;
}

}  // namespace spool
