// The sampler of [LiuZheng (section 3)], step by step in the order of the text.
#include "lib/sampling/multiscale/multiscale.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "lib/core/random.h"
#include "lib/sampling/multiscale/analysis.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/board_views.h"
#include "lib/sampling/multiscale/epoch_update.h"
#include "lib/sampling/multiscale/exact_update.h"
#include "lib/sampling/multiscale/reach.h"
#include "lib/sampling/multiscale/samples.h"
#include "lib/sampling/multiscale/shared_progress.h"
#include "lib/sampling/multiscale/tile_budgets.h"
#include "lib/sampling/multiscale/tile_results.h"
#include "lib/sampling/spending.h"
#include "lib/sampling/tile_plan.h"

namespace spool {
namespace {

constexpr std::uint64_t kTileLane = 3;  // of random numbers

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

  results.hand_over(result, context.views);
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
