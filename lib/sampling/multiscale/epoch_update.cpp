#include "lib/sampling/multiscale/epoch_update.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "lib/core/parallel.h"
#include "lib/sampling/multiscale/block_analysis.h"
#include "lib/sampling/multiscale/region_sampling.h"
#include "lib/sampling/multiscale/step_blocks.h"
#include "lib/sampling/priority_order.h"

namespace spool {
namespace {

class EpochUpdate final : public Update {
 public:
  EpochUpdate(EpochBoard& board, long long share, const MultiscaleOptions& options)
      : board_(board),
        options_(options),
        share_(share),
        analysis_(board, options),
        grid_(board.bounds()),
        maxima_(board.priority, 1) {}

  const std::vector<Pick>& choose(const Samples& samples, const SamplePool& pool, long long left,
                                  BoardLog& log) override {
    const long long wanted = std::min(share_, left);
    picks_ = {};  // nor is their memory needed while candidates are ordered
    old_f0_ = {};
    Asked asked(board_.window.width(), board_.window.height());
    PriorityOrder<float> order(maxima_, static_cast<std::size_t>(wanted) / 4,
                               [&](const RegionEntry& entry) { return is_free(entry, asked); });
    std::vector<Pick> of_cut_regions;
    double lowest = 0.0;
    for (long long chosen = 0; chosen < wanted;) {
      const std::optional<RegionEntry> entry = order.next();
      if (!entry) break;
      const Rectangle region = sampled_region(board_, *entry);
      const long long may = left - chosen;
      int each = 0;
      if (region.area() <= may) {
        each = options_.step_counts == StepCounts::kPredicted
                   ? predicted_count(entry->priority, lowest_of_last_)
                   : 1;
        each = static_cast<int>(std::min<long long>(each, may / region.area()));
        const long long samples_of_region = offered(board_, samples, pool, region, each);
        record_samples(log, entry->level, samples_of_region);
        chosen += samples_of_region;
      } else {
        const std::size_t first = of_cut_regions.size();
        chosen += choose_pieces(board_, samples, pool, region, 1, may, of_cut_regions);
        record_region(log, entry->level, std::span(of_cut_regions).subspan(first));
      }
      for (int y = region.y0; y < region.y1; ++y)
        std::fill(&asked(0, y) + region.x0, &asked(0, y) + region.x1, ask(entry->level, each));
      lowest = entry->priority;  // they come in falling order
    }
    lowest_of_last_ = lowest;
    collect(asked, samples, pool, log);
    picks_.insert(picks_.end(), of_cut_regions.begin(), of_cut_regions.end());
    if (!picks_.empty()) remember();
    return picks_;
  }

  void update_images(GuardCounts& guards) override {
    analysis_.update_pieces(picks_, old_f0_);
    std::vector<GuardCounts> caught(grid_.size());
    parallel_for(grid_.size(), [&](std::size_t b) {
      const Rectangle box = intersect(changed_[b], board_.area);
      if (box.empty()) return;
      analysis_.update(box, caught[b]);
      for (int k = 1; k <= options_.levels(); ++k)
        maxima_.refresh(k, box);
    });
    for (const GuardCounts& block : caught)
      guards += block;
  }

  // P was computed with the images; what has run out since is closed.
  void update_priorities(GuardCounts&) override {
    if (board_.closed_pieces == 0) return;
    parallel_for(grid_.size(), [&](std::size_t b) {
      const Rectangle box = intersect(changed_[b], board_.area);
      if (!box.empty()) analysis_.close(box);
    });
  }

 private:
  // Per piece: 0 where no region of the step lies, else 16 times the region's level, plus the
  // samples that each of its pieces is asked for; 0 of those in a region that was cut short.
  using Asked = Image<std::uint8_t>;
  static_assert(kMostPredicted < 16);
  static std::uint8_t ask(int level, int each) {
    return static_cast<std::uint8_t>(16 * level + each);
  }

  bool is_free(const RegionEntry& entry, const Asked& asked) const {
    const Rectangle r = sampled_region(board_, entry);
    for (int y = r.y0; y < r.y1; ++y) {
      const std::uint8_t* row = &asked(0, y);
      if (std::any_of(row + r.x0, row + r.x1, [](std::uint8_t t) { return t != 0; })) return false;
    }
    return true;
  }

  // What is asked for as picks, by y, then x, which is the order of the images that they touch:
  // taking them is mostly waiting for memory.
  void collect(const Asked& asked, const Samples& samples, const SamplePool& pool, BoardLog& log) {
    const int height = asked.height();
    const auto picked = [&](int x, int y) { return asked(x, y) % 16 > 0 && !board_.closed(x, y); };
    std::vector<std::size_t> end(static_cast<std::size_t>(height));  // of a row, in picks_
    parallel_rows(0, height, [&](int y) {
      for (int x = 0; x < asked.width(); ++x)
        end[static_cast<std::size_t>(y)] += picked(x, y);
    });
    std::partial_sum(end.begin(), end.end(), end.begin());
    picks_.resize(end.back());
    parallel_rows(0, height, [&](int y) {
      std::size_t at = y == 0 ? 0 : end[static_cast<std::size_t>(y) - 1];
      for (int x = 0; x < asked.width(); ++x) {
        if (!picked(x, y)) continue;
        const int count = offered(board_, samples, pool, x, y, asked(x, y) % 16);
        board_.fresh(x, y) = static_cast<std::uint8_t>(count);
        picks_[at++] = {x, y, count};
        if (!log.level_of_samples.empty()) log.level_of_samples[asked(x, y) / 16](x, y) += count;
      }
    });
  }

  // What the step will change, and f_0 of its pieces before it.
  void remember() {
    changed_ = grid_.changed(picks_, analysis_.reach());
    old_f0_.assign(board_.scalars.size(), std::vector<float>(picks_.size()));
    for (std::size_t i = 0; i < board_.scalars.size(); ++i) {
      const Image<float>& f0 = board_.scalars[i].pyramid.coarse[0];
      parallel_for(picks_.size(),
                   [&](std::size_t p) { old_f0_[i][p] = f0(picks_[p].x, picks_[p].y); });
    }
  }

  EpochBoard& board_;
  const MultiscaleOptions& options_;
  const long long share_;
  const BlockAnalysis analysis_;
  const BlockGrid grid_;
  PriorityMaxima<float> maxima_;  // closing a region need not lower them
  double lowest_of_last_ = 0.0;   // smallest priority of a region that the last step took
  std::vector<Pick> picks_;
  std::vector<Rectangle> changed_;          // [block]
  std::vector<std::vector<float>> old_f0_;  // [scalar][pick]
};

}  // namespace

std::unique_ptr<Update> epoch_update(EpochBoard& board, long long budget,
                                     const MultiscaleOptions& options) {
  const long long epochs = epoch_count(options);
  return std::make_unique<EpochUpdate>(board, (budget + epochs - 1) / epochs, options);
}

}  // namespace spool
