#include "lib/sampling/multiscale/exact_update.h"

#include <optional>

#include "lib/pyramid/region_mean.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/region_sampling.h"
#include "lib/sampling/priority_maxima.h"

namespace spool {

BeforeStep remember(const ExactBoard& board, const Rectangle& changed,
                    const MultiscaleOptions& options) {
  BeforeStep step;
  step.changed = changed;
  pyramid_influence(changed, board.bounds(), board_pyramid(options), step.coarse_boxes,
                    step.detail_boxes);
  const auto count = static_cast<std::size_t>(options.levels()) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    step.attenuation_boxes.push_back(
        attenuation_box(board, static_cast<int>(k), changed, step.coarse_boxes[k], options));
  }
  for (const ScalarAnalysis<double>& scalar : board.scalars) {
    std::vector<Plane>& coarse = step.coarse.emplace_back();
    for (std::size_t k = 0; k < count; ++k)
      coarse.push_back(cropped(scalar.pyramid.coarse[k], step.attenuation_boxes[k]));
  }
  return step;
}

void update_analysis(ExactBoard& board, const BeforeStep& step, const MultiscaleOptions& options) {
  const PyramidOptions pyramid = board_pyramid(options);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis<double>& scalar = board.scalars[i];
    update_pyramid(scalar.pyramid, step.changed, pyramid);  // eqs 1-4
    for (int k = 1; k <= options.levels(); ++k) {           // eq 6
      const Rectangle box = region_influence(step.changed, k, board.bounds());
      update_variance_term(scalar, k, box);
    }
    for (std::size_t k = 0; k < step.attenuation_boxes.size(); ++k) {  // eqs 7, 8
      update_attenuation(board, scalar, static_cast<int>(k), step.attenuation_boxes[k],
                         step.coarse[i][k], options);
    }
  }
}

std::vector<Rectangle> priority_boxes(const ExactBoard& board, const BeforeStep& step,
                                      const MultiscaleOptions& options) {
  std::vector<Rectangle> boxes;
  for (int k = 1; k <= options.levels(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    Rectangle box = region_influence(step.changed, k, board.bounds());
    box = unite(box, step.attenuation_boxes[i]);
    box = unite(box, step.detail_boxes[static_cast<std::size_t>(detail_of_level(k, options))]);
    if (options.detail_norm == DetailNorm::kRelative) box = unite(box, step.coarse_boxes[i]);
    boxes.push_back(intersect(box, board.area));
  }
  return boxes;
}

namespace {

class ExactUpdate final : public Update {
 public:
  ExactUpdate(ExactBoard& board, const MultiscaleOptions& options)
      : board_(board), options_(options), maxima_(board.priority, 1) {}

  const std::vector<Pick>& choose(const Samples& samples, const SamplePool& pool, long long left,
                                  BoardLog& log) override {
    picks_.clear();
    const std::optional<RegionEntry> best = maxima_.best();
    if (!best || best->priority <= 0.0) return picks_;
    const Rectangle region = sampled_region(board_, *best);
    before_ = remember(board_, region, options_);
    choose_pieces(board_, samples, pool, region, 1, left, picks_);
    record_region(log, best->level, picks_);
    return picks_;
  }

  void update_images(GuardCounts&) override { update_analysis(board_, before_, options_); }

  void update_priorities(GuardCounts& guards) override {
    const std::vector<Rectangle> boxes = priority_boxes(board_, before_, options_);
    for (int k = 1; k <= options_.levels(); ++k) {
      const Rectangle& box = boxes[static_cast<std::size_t>(k - 1)];
      update_priority(board_, k, box, options_, guards);
      maxima_.refresh(k, box);
    }
  }

 private:
  ExactBoard& board_;
  const MultiscaleOptions& options_;
  PriorityMaxima<double> maxima_;
  std::vector<Pick> picks_;
  BeforeStep before_;
};

}  // namespace

std::unique_ptr<Update> exact_update(ExactBoard& board, const MultiscaleOptions& options) {
  return std::make_unique<ExactUpdate>(board, options);
}

}  // namespace spool
