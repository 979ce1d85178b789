// The sampler of [LiuZheng (section 3)], step by step in the order of the text.
#include "lib/sampling/multiscale/multiscale.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/sampling/multiscale/analysis.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/board_views.h"
#include "lib/sampling/multiscale/epoch_update.h"
#include "lib/sampling/multiscale/exact_update.h"
#include "lib/sampling/multiscale/samples.h"
#include "lib/sampling/multiscale/tile_budgets.h"
#include "lib/sampling/multiscale/tile_results.h"
#include "lib/sampling/spending.h"
#include "lib/sampling/tile_plan.h"

namespace spool {
namespace {

constexpr std::uint64_t kTileLane = 3;  // of random numbers

// How far from a changed piece the images of each level change, in x and y alike.
struct StepReach {
  std::vector<int> coarse;  // of f_0, f_1, ...
  std::vector<int> detail;  // of d_0, d_1, ...
};

StepReach step_reach(const MultiscaleOptions& options) {
  // Far from every border. A change near one is mirrored, and then acts to the other side: so the
  // larger of both sides counts for both.
  constexpr int kFar = 1 << 14;
  std::vector<Rectangle> coarse, detail;
  pyramid_influence({kFar, kFar, kFar + 1, kFar + 1}, {0, 0, 2 * kFar, 2 * kFar},
                    board_pyramid(options), coarse, detail);
  const auto reach_of = [](const Rectangle& box) {
    return std::max(kFar - box.x0, box.x1 - 1 - kFar);
  };
  StepReach reach;
  for (const Rectangle& box : coarse)
    reach.coarse.push_back(reach_of(box));
  for (const Rectangle& box : detail)
    reach.detail.push_back(reach_of(box));
  return reach;
}

// Pieces whose statistics can change an analysis of `area`: area, grown by the reach of the
// filters, its corner on the lattice of the coarsest level.
Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options) {
  const StepReach step = step_reach(options);
  int reach = 1 << (options.levels() - 1);
  for (const std::vector<int>* of : {&step.coarse, &step.detail})
    reach = std::max(reach, *std::max_element(of->begin(), of->end()));
  Rectangle window = grow(area, reach, reach, reach, reach, bounds);
  const int lattice = 1 << (options.levels() + 1);  // phase00 counts phases from the corner
  window.x0 -= window.x0 % lattice;
  window.y0 -= window.y0 % lattice;
  return window;
}

// A tile as the board of the whole grid was when it was loaded, with its view of its
// neighbours.
template <class T>
AnalysedBoard<T> tile_board(const AnalysedBoard<T>& whole, const Rectangle& tile,
                            const MultiscaleOptions& options, bool all_images,
                            GuardCounts& guards) {
  const Rectangle window =
      options.tile_halo == TileHalo::kFrozen ? analysis_window(tile, whole.window, options) : tile;
  AnalysedBoard<T> board = cut_board(whole, window, tile);
  analyse(board, options, all_images, guards);  // (1)-(6)
  return board;
}

// Images that update=epoch has no need to keep.
bool wants_detail_or_contrast(const Views* views) {
  return views != nullptr && (views->wants("d") || views->wants("V") || views->wants("d_initial") ||
                              views->wants("V_initial"));
}

std::unique_ptr<Update> make_update(ExactBoard& board, long long,
                                    const MultiscaleOptions& options) {
  return exact_update(board, options);
}
std::unique_ptr<Update> make_update(EpochBoard& board, long long budget,
                                    const MultiscaleOptions& options) {
  return epoch_update(board, budget, options);
}

// Progress and cancellation of a run, from several tiles at once.
class SharedProgress {
 public:
  SharedProgress(const SamplingContext& context, long long budget)
      : context_(context), budget_(budget) {}

  // `taken`: samples since the last call; false when the run is to stop.
  bool operator()(long long taken) {
    const std::lock_guard lock(mutex_);
    spent_ += taken;
    if (context_.progress) {
      context_.progress(static_cast<double>(spent_) / static_cast<double>(std::max(budget_, 1LL)));
    }
    if (context_.cancelled != nullptr && (*context_.cancelled)()) cancelled_ = true;
    return !cancelled_;
  }
  bool cancelled() const { return cancelled_; }

 private:
  const SamplingContext& context_;
  long long budget_;
  long long spent_ = 0;
  bool cancelled_ = false;
  std::mutex mutex_;
};

// Samples where P is largest, and what they change, again and again until the budget is spent.
template <class T>
void spend_budget(AnalysedBoard<T>& board, Update& update, Samples& samples, const SamplePool& pool,
                  long long budget, std::uint64_t seed, const MultiscaleOptions& options,
                  SharedProgress& progress, BoardLog& log) {
  bool go_on = true;
  while (log.spent < budget && go_on) {
    const long long before = log.spent;
    const std::vector<Pick>& picks = update.choose(samples, pool, budget - before, log);
    if (picks.empty()) {  // no region has a priority
      const auto rest = choose_uniformly(board, samples, pool, budget - before, seed);
      take_picks(board, samples, pool, rest, options, log.guards);
      end_step(board, samples, pool, rest);
      record_region(log, 0, rest);
      log.uniform_remainder += log.spent - before;
      return;
    }
    take_picks(board, samples, pool, picks, options, log.guards);

    // Coarse and detail images, contrast and attenuation of what changed [LiuZheng (1)-(4),
    // (6)-(8)]
    update.update_images(log.guards);
    end_step(board, samples, pool, picks);

    // Priority [LiuZheng (5)]
    update.update_priorities(log.guards);
    go_on = progress(log.spent - before);
  }
}

template <class T>
Result<SamplingResult> sample(const SamplePool& pool, long long budget,
                              const MultiscaleOptions& options, const SamplingContext& context) {
  const Rectangle grid{0, 0, pool.width(), pool.height()};
  SPOOL_ASSIGN(const std::vector<Rectangle> tiles,
               plan_tiles(pool.width(), pool.height(), options.tile, 1 << options.levels()));
  SharedProgress progress(context, budget);
  SamplingResult result;
  result.log.budget = budget;
  result.log.samples_of_level.assign(static_cast<std::size_t>(options.levels()) + 1, 0);

  // The first samples of every piece, and the exposure of everything that decides
  Samples samples = first_samples(pool, budget, options, context.seed, result.log);
  const long long left =
      std::min(budget, pool.total_capacity()) - count_samples(samples.statistics.n);
  progress(budget - left);

  // Coarse and detail images, contrast, priority; A is at its start [LiuZheng (1)-(6)]
  const bool all_images = wants_detail_or_contrast(context.views);
  AnalysedBoard<T> image = load_board<T>(samples, pool, grid, grid, options, result.log.guards);
  analyse(image, options, all_images, result.log.guards);
  add_board_views(image, "_initial", options, context.views);

  // The budget of each tile [LiuZheng (13)]
  const std::vector<long long> budgets = tile_budgets(tiles, image, samples, pool, left, options);
  if (tiles.size() > 1) forget_analysis(image);

  // Each tile alone, until its budget is spent [LiuZheng (1)-(8)]
  TileResults results(tiles.size(), grid, context.views, options);
  for_each_tile(budgets, options.parallel == ParallelOver::kTiles, [&](std::size_t t) {
    GuardCounts guards;
    AnalysedBoard<T> board = tiles.size() == 1
                                 ? std::move(image)
                                 : tile_board(image, tiles[t], options, all_images, guards);
    BoardLog log = make_board_log(board, options, results.wants_level_images());
    log.guards = guards;
    const std::unique_ptr<Update> update = make_update(board, budgets[t], options);
    spend_budget(board, *update, samples, pool, budgets[t], mix(context.seed, kTileLane, t),
                 options, progress, log);
    results.add(t, std::move(board), std::move(log));
  });
  if (progress.cancelled()) return fail(ErrorCode::kData, "multiscale: cancelled");

  results.hand_over(result, samples.explored, context.views);
  result.selection.statistics = std::move(samples.statistics);
  finish_log(result.log, pool, result.selection.statistics.n);
  return result;
}

}  // namespace

Result<SamplingResult> sample_multiscale(const SamplePool& pool, long long budget,
                                         const MultiscaleOptions& options,
                                         const SamplingContext& context) {
  SPOOL_CHECK_GE(budget, 0);
  return options.update == UpdateMode::kExact ? sample<double>(pool, budget, options, context)
                                              : sample<float>(pool, budget, options, context);
}

Sampler multiscale_sampler() {
  return make_value<SamplerFunction, MultiscaleOptions>(
      {.name = "multiscale",
       .summary = "regions of many sizes, by contrast, lost detail and change",
       .options = multiscale_option_table(),
       .presets = multiscale_presets(),
       .readings = multiscale_readings(),
       .views =
           {
               {"f.k", "coarse images at the end (eqs 1-3)"},
               {"d.k", "detail images at the end (eq 4)"},
               {"V.k", "contrast of the regions at the end (eq 6)"},
               {"A.k", "attenuation at the end (eqs 7, 8)"},
               {"P.k", "priorities at the end (eq 5)"},
               {"f_initial.k", "coarse images after the first samples"},
               {"d_initial.k", "detail images after the first samples"},
               {"V_initial.k", "contrast after the first samples"},
               {"A_initial.k", "attenuation after the first samples"},
               {"P_initial.k", "priorities after the first samples"},
               {"samples.k", "samples that regions of level k took; 0: uniformly spent"},
           },
       .memory = {208, 2.9e6},
       .cost = 1.55,
       .run = sample_multiscale});
}

}  // namespace spool
