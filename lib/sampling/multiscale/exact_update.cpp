#include "lib/sampling/multiscale/exact_update.h"

#include <algorithm>

#include "lib/core/random.h"
#include "lib/pyramid/region_mean.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/multiscale/sampling_loop.h"
#include "lib/sampling/region_queue.h"

namespace spool {
namespace {

Plane copy_box(const Plane& image, const Rectangle& box) {
  Plane copy(std::max(box.width(), 0), std::max(box.height(), 0));
  for (int y = 0; y < copy.height(); ++y) {
    for (int x = 0; x < copy.width(); ++x)
      copy(x, y) = image(box.x0 + x, box.y0 + y);
  }
  return copy;
}

}  // namespace

BeforeStep remember(const Board& board, const Rectangle& changed,
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
  for (const ScalarAnalysis& scalar : board.scalars) {
    std::vector<Plane>& coarse = step.coarse.emplace_back();
    for (std::size_t k = 0; k < count; ++k)
      coarse.push_back(copy_box(scalar.pyramid.coarse[k], step.attenuation_boxes[k]));
  }
  return step;
}

void update_analysis(Board& board, const BeforeStep& step, const MultiscaleOptions& options,
                     GuardCounts& guards) {
  const PyramidOptions pyramid = board_pyramid(options);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    update_pyramid(scalar.pyramid, step.changed, pyramid);  // eqs 1-4
    for (int k = 1; k <= options.levels(); ++k) {           // eq 6
      const Rectangle box = region_influence(step.changed, k, board.bounds());
      update_variance_term(scalar, k, box, options, guards);
    }
    for (std::size_t k = 0; k < step.attenuation_boxes.size(); ++k) {  // eqs 7, 8
      update_attenuation(board, scalar, static_cast<int>(k), step.attenuation_boxes[k],
                         step.coarse[i][k], options);
    }
  }
}

std::vector<Rectangle> priority_boxes(const Board& board, const BeforeStep& step,
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

LoopLog run_exact(Board& board, Samples& samples, const SamplePool& pool, long long budget,
                  const MultiscaleOptions& options, const LoopControl& control) {
  LoopLog log = make_loop_log(board, options, control);
  RegionQueue queue(board.window.width(), board.window.height(), options.levels());
  for (int k = 1; k <= options.levels(); ++k)
    queue.refresh(board.priority, k, board.area);

  std::vector<Pick> picks;
  for (std::uint64_t pop = 0; log.spent < budget; ++pop) {
    const RegionEntry best = queue.best();
    if (best.level == 0) break;  // everything is saturated
    if (options.stop_priority && best.priority <= *options.stop_priority) break;
    if (best.priority <= 0.0) {
      spend_remainder(board, samples, pool, budget - log.spent, options, control, log);
      break;
    }
    const Rectangle region = sampled_region(board, best);
    const BeforeStep before = remember(board, region, options);
    picks.clear();
    const long long taken = choose_pieces(board, samples, pool, region, budget - log.spent,
                                          mix(control.seed, pop), options, picks);
    take_picks(board, samples, pool, picks, options, log.guards);
    record_pop(log, best.level, picks);

    update_analysis(board, before, options, log.guards);
    end_step(board, samples, pool, picks);
    const std::vector<Rectangle> boxes = priority_boxes(board, before, options);
    for (int k = 1; k <= options.levels(); ++k) {
      const Rectangle& box = boxes[static_cast<std::size_t>(k - 1)];
      update_priority(board, k, box, options, log.guards);  // eq 5
      queue.refresh(board.priority, k, box);
    }
    if (control.report && !control.report(taken)) break;
  }
  return log;
}

}  // namespace spool
