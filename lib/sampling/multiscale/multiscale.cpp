#include "lib/sampling/multiscale/multiscale.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/board_views.h"
#include "lib/sampling/multiscale/sampling_loop.h"
#include "lib/sampling/multiscale/tile_budgets.h"
#include "lib/sampling/spending.h"
#include "lib/sampling/tile_plan.h"

namespace spool {
namespace {

enum Lane : std::uint64_t { kInitialLane = 1, kExploreLane = 2, kTileLane = 3 };

// Progress and cancellation, from several tiles at once.
class Reporter {
 public:
  Reporter(const SamplingContext& context, long long budget) : context_(context), budget_(budget) {}

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

void copy_area(const Board& board, const Plane& from, Plane& to) {
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x)
      to(x + board.window.x0, y + board.window.y0) = from(x, y);
  }
}

// A_k of a board, which loses it; the mean over the analysed scalars where there are several.
Plane mean_attenuation(Board& board, std::size_t k) {
  Plane mean = std::move(board.scalars[0].attenuation[k]);
  if (board.scalars.size() == 1) return mean;
  for (std::size_t p = 0; p < mean.size(); ++p) {
    double sum = mean[p];
    for (std::size_t i = 1; i < board.scalars.size(); ++i)
      sum += board.scalars[i].attenuation[k][p];
    mean[p] = sum / static_cast<double>(board.scalars.size());
  }
  return mean;
}

void add(SamplingLog& log, const LoopLog& part) {
  log.uniform_remainder += part.uniform_remainder;
  for (std::size_t k = 0; k < part.samples_of_level.size(); ++k)
    log.samples_of_level[k] += part.samples_of_level[k];
  log.guards += part.guards;
}

}  // namespace

Result<SamplingResult> sample_multiscale(const SamplePool& pool, long long budget,
                                         const MultiscaleOptions& options,
                                         const SamplingContext& context) {
  SPOOL_CHECK_GE(budget, 0);
  const Rectangle grid{0, 0, pool.width(), pool.height()};
  SPOOL_ASSIGN(const std::vector<Rectangle> tiles,
               plan_tiles(pool.width(), pool.height(), options.tile, 1 << options.levels()));
  SamplingResult result;
  SamplingLog& log = result.log;
  log.budget = budget;
  log.samples_of_level.assign(static_cast<std::size_t>(options.levels()) + 1, 0);

  // The first samples of every piece.
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  PieceStatistics first =
      prefix_statistics(pool, initial_counts(pool, budget, each, mix(context.seed, kInitialLane)));
  log.initial = count_samples(first.n);

  // The exposure of everything that decides, frozen from here on.
  const double exposure = options.exposure == ExposureMode::kNormalise
                              ? exposure_of(first, options.key, log.guards)
                              : 1.0;
  long long left = std::min(budget, pool.total_capacity()) - log.initial;

  // A share of the rest, uniformly, if asked for.
  const auto explored =
      static_cast<long long>(options.explore_fraction * static_cast<double>(left));
  if (explored > 0) {
    first = prefix_statistics(
        pool, raise_least_sampled(first.n, pool, grid, explored, mix(context.seed, kExploreLane)));
    log.samples_of_level[0] += explored;
    left -= explored;
  }
  Samples samples = make_samples(std::move(first), pool, exposure, options);
  Reporter reporter(context, budget);
  reporter(budget - left);

  std::vector<Plane> before_last;
  if (options.attenuation_start == AttenuationStart::kSplit && each >= 2) {
    for (std::size_t i = 0; i < samples.scalars(); ++i)
      before_last.push_back(means_before_last(samples, pool, i));
  }

  // Eqs 1-6 over the whole image; every attenuation is at its start.
  Board image = load_board(samples, pool, grid, grid, options, log.guards);
  analyse(image, before_last, options, log.guards);
  if (context.views != nullptr) {
    BoardViews views(context.views, "_initial", grid.width(), grid.height(), options);
    views.paste(image);
    views.hand_over(*context.views);
  }

  // Eq 13: the budget of each tile.
  const std::vector<long long> budgets = tile_budgets(tiles, image, samples, pool, left, options);
  if (tiles.size() > 1) forget_analysis(image);

  // Each board alone: eqs 5-8 until its budget is spent.
  BoardViews views(context.views, "", grid.width(), grid.height(), options);
  LevelViews level_views(context.views, grid.width(), grid.height(), options.levels());
  std::vector<LoopLog> logs(tiles.size());
  std::vector<GuardCounts> tile_guards(tiles.size());
  std::vector<Plane>& attenuation = result.selection.attenuation;
  const auto attenuations = static_cast<std::size_t>(options.levels()) + 1;
  if (tiles.size() > 1) attenuation.assign(attenuations, Plane(grid.width(), grid.height()));
  const auto run = [&](std::size_t t) {
    Board board;
    if (tiles.size() == 1) {
      board = std::move(image);
    } else {
      const Rectangle window = options.tile_halo == TileHalo::kFrozen
                                   ? analysis_window(tiles[t], grid, options)
                                   : tiles[t];
      board = cut_board(image, window, tiles[t], options);
      analyse(board, before_last, options, tile_guards[t]);
    }
    LoopControl control;
    control.seed = mix(context.seed, kTileLane, t);
    control.keep_level_images = level_views.wanted();
    control.keep_details = context.views != nullptr;
    control.report = [&](long long taken) { return reporter(taken); };
    logs[t] = options.update == UpdateMode::kExact
                  ? run_exact(board, samples, pool, budgets[t], options, control)
                  : run_epochs(board, samples, pool, budgets[t], options, control);
    views.paste(board);
    level_views.paste(board, logs[t].level_of_samples);
    for (std::size_t k = 0; k < attenuations; ++k) {
      if (tiles.size() == 1) {
        attenuation.push_back(mean_attenuation(board, k));
      } else {
        copy_area(board, mean_attenuation(board, k), attenuation[k]);
      }
    }
  };
  std::vector<std::size_t> order(tiles.size());  // largest budget first
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return budgets[a] > budgets[b]; });
  if (options.parallel == ParallelOver::kTiles) {
    std::atomic<std::size_t> next{0};
    parallel_for(tiles.size(), [&](std::size_t) { run(order[next++]); });
  } else {
    for (const std::size_t t : order)
      run(t);
  }
  if (reporter.cancelled()) return fail(ErrorCode::kData, "multiscale: cancelled");

  for (std::size_t t = 0; t < tiles.size(); ++t) {
    add(log, logs[t]);
    log.guards += tile_guards[t];
  }
  if (context.views != nullptr) {
    views.hand_over(*context.views);
    level_views.hand_over(*context.views);
  }
  result.selection.statistics = std::move(samples.statistics);
  finish_log(log, pool, result.selection.statistics.n);
  return result;
}

Sampler multiscale_sampler() {
  return make_value<SamplerFunction, MultiscaleOptions>(
      {.name = "multiscale",
       .summary = "regions of many sizes, by contrast, lost detail and change",
       .options = multiscale_option_table(),
       .presets = multiscale_presets(),
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
       .memory = {326, 2.9e6},
       .run = sample_multiscale});
}

}  // namespace spool
