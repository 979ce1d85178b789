#include "lib/sampling/multiscale/epoch_update.h"

#include <algorithm>
#include <optional>

#include "lib/core/parallel.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/region_sampling.h"
#include "lib/sampling/multiscale/step_blocks.h"
#include "lib/sampling/priority_order.h"

namespace spool {
namespace {

class EpochUpdate final : public Update {
 public:
  EpochUpdate(Board& board, long long share, const MultiscaleOptions& options)
      : board_(board),
        options_(options),
        share_(share),
        pyramid_(board_pyramid(options)),
        grid_(board.bounds()),
        reach_(step_reach(options)),
        maxima_(board.priority, 1) {
    for (ScalarAnalysis& scalar : board_.scalars)
      scalar.pyramid.detail.clear();  // only P needs them, a row at a time
  }

  const std::vector<Pick>& choose(const Samples& samples, const SamplePool& pool, long long left,
                                  BoardLog& log) override {
    const long long wanted = std::min(share_, left);
    Image<std::uint8_t> taken(board_.window.width(), board_.window.height());
    PriorityOrder order(maxima_, static_cast<std::size_t>(wanted) / 4,
                        [&](const RegionEntry& entry) { return is_free(entry, taken); });
    picks_.clear();
    double lowest = 0.0;
    for (long long chosen = 0; chosen < wanted;) {
      const std::optional<RegionEntry> entry = order.next();
      if (!entry) break;
      const Rectangle region = sampled_region(board_, *entry);
      for (int y = region.y0; y < region.y1; ++y)
        std::fill(&taken(0, y) + region.x0, &taken(0, y) + region.x1, std::uint8_t{1});
      const std::size_t first = picks_.size();
      const int each = options_.step_counts == StepCounts::kPredicted
                           ? predicted_count(entry->priority, lowest_of_last_)
                           : 1;
      chosen += choose_pieces(board_, samples, pool, region, each, left - chosen, picks_);
      lowest = entry->priority;  // they come in falling order
      record_region(log, entry->level, std::span(picks_).subspan(first));
    }
    lowest_of_last_ = lowest;
    if (picks_.empty()) return picks_;
    sort_by_place(picks_, board_.bounds());
    remember();
    return picks_;
  }

  // A level needs the whole of the one before it: one pass each.
  void update_images(GuardCounts& guards) override {
    for (std::size_t i = 0; i < board_.scalars.size(); ++i)
      update_attenuation_of_pieces(board_, board_.scalars[i], picks_, old_f0_[i], options_);
    std::vector<GuardCounts> caught(grid_.size());
    for (int k = 0; k <= pyramid_.levels; ++k) {
      parallel_for(grid_.size(), [&](std::size_t b) { analyse_level(k, b, caught[b]); });
    }
    for (const GuardCounts& block : caught)
      guards += block;
  }

  // P was computed with the details, which are not kept; what has run out since is closed.
  void update_priorities(GuardCounts&) override {
    if (board_.closed_pieces == 0) return;
    parallel_for(grid_.size(), [&](std::size_t b) {
      for (int k = 1; k <= options_.levels(); ++k)
        close_regions(board_, k, step_->priority[static_cast<std::size_t>(k)][b]);
    });
  }

  void restore_details() override {
    for (ScalarAnalysis& scalar : board_.scalars)
      rebuild_pyramid(scalar.pyramid, scalar.pyramid.coarse[0], pyramid_);
  }

 private:
  bool is_free(const RegionEntry& entry, const Image<std::uint8_t>& taken) const {
    const Rectangle r = sampled_region(board_, entry);
    for (int y = r.y0; y < r.y1; ++y) {
      const std::uint8_t* row = &taken(0, y);
      if (std::any_of(row + r.x0, row + r.x1, [](std::uint8_t t) { return t != 0; })) return false;
    }
    return true;
  }

  // What the step will change, and f_0 of its pieces before it.
  void remember() {
    step_.emplace(board_, grid_, reach_, picks_, options_);
    old_f0_.assign(board_.scalars.size(), std::vector<double>(picks_.size()));
    for (std::size_t i = 0; i < board_.scalars.size(); ++i) {
      const Plane& f0 = board_.scalars[i].pyramid.coarse[0];
      for (std::size_t p = 0; p < picks_.size(); ++p)
        old_f0_[i][p] = f0(picks_[p].x, picks_[p].y);
    }
  }

  // P_k with d_{k-1}, then f_{k+1}, A_{k+1} and V_{k+1} of one block.
  void analyse_level(int k, std::size_t b, GuardCounts& guards) {
    for (int p = 1; p <= options_.levels(); ++p) {
      if (detail_of_level(p, options_) != k - 1) continue;
      const Rectangle& box = step_->priority[static_cast<std::size_t>(p)][b];
      compute_priority_from_coarse(board_, p, box, options_, guards);  // eqs 4, 5
      maxima_.refresh(p, box);
    }
    if (k == pyramid_.levels) return;
    for (ScalarAnalysis& scalar : board_.scalars) {
      coarsen(scalar, k, b);                 // eqs 1-3, 7, 8
      if (k == options_.levels()) continue;  // one level more for d_index = same_k
      const auto level = static_cast<std::size_t>(k) + 1;
      update_variance_term(scalar, k + 1, step_->variance[level][b]);  // eq 6
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
  const long long share_;
  const PyramidOptions pyramid_;
  const BlockGrid grid_;
  const StepReach reach_;
  PriorityMaxima maxima_;        // closing a region need not lower them
  double lowest_of_last_ = 0.0;  // smallest priority of a region that the last step took
  std::vector<Pick> picks_;
  std::optional<StepBlocks> step_;
  std::vector<std::vector<double>> old_f0_;  // [scalar][pick]
};

}  // namespace

std::unique_ptr<Update> epoch_update(Board& board, long long budget,
                                     const MultiscaleOptions& options) {
  const long long epochs = epoch_count(options);
  return std::make_unique<EpochUpdate>(board, (budget + epochs - 1) / epochs, options);
}

}  // namespace spool
