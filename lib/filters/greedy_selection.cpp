#include "lib/filters/greedy_selection.h"

#include <cmath>

#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

void open_stops(Plane& stop, double sigma) {
  const Plane votes = neighbour_votes(stop, sigma);
  for (std::size_t i = 0; i < stop.size(); ++i) {
    if (!votes_to_stop(votes[i])) stop[i] = 0.0;
  }
}

}  // namespace

double greedy_scale(int s) {
  return std::pow(2.0, 0.5 * (s - 2));
}

Result<Reconstruction> reconstruct_greedy_selection(const Selection& selection,
                                                    const SamplePool& pool,
                                                    const GreedySelectionOptions& options,
                                                    const FilterContext& context) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  SPOOL_ASSIGN(const LadderBase base,
               make_ladder_base(statistics, pool, options.grid, {options.var_mode}, exposure,
                                result.guards));
  Scale scale = base_scale(base);
  const int width = base.count.width(), height = base.count.height();

  // One transition after the other; a pixel that has stopped stays where it is
  result.variance.emplace();
  for (std::size_t c = 0; c < 3; ++c) {
    result.image[c] = scale.channels[c].image;
    (*result.variance)[c] = scale.channels[c].variance;
  }
  CountImage level(width, height, 0);
  const double caution = transition_caution(options.gamma);
  for (int s = 1; s <= options.scales; ++s) {
    const double sigma = greedy_scale(s);
    Plane stop =
        climb(scale, base, s, sigma, transition_beta(s, sigma, greedy_scale(s - 1)), caution);
    open_stops(stop, options.alpha * sigma);
    parallel_rows(0, height, [&](int y) {
      for (std::size_t i = level.index(0, y); i < level.index(0, y + 1); ++i) {
        if (level[i] < s - 1 || stop[i] > 0.0) continue;
        level[i] = s;
        for (std::size_t c = 0; c < 3; ++c) {
          result.image[c][i] = scale.channels[c].image[i];
          (*result.variance)[c][i] = scale.channels[c].variance[i];
        }
      }
    });
    if (context.views) context.views->add(fmt::format("stop.{}", s), stop);
    if (context.progress) context.progress(static_cast<double>(s) / options.scales);
  }
  if (context.views && context.views->wants("level")) {
    Plane view(width, height);
    for (std::size_t i = 0; i < view.size(); ++i)
      view[i] = level[i];
    context.views->add("level", view);
  }
  result.level = std::move(level);
  return result;
}

Filter greedy_selection_filter() {
  using O = GreedySelectionOptions;
  return make_value<FilterFunction, O>(
      {.name = "greedy_selection",
       .summary = "each pixel's best Gaussian by incremental bias and variance",
       .options =
           {
               expert(choice_option("grid", &O::grid,
                                    {{"auto", GreedyGrid::kAuto},
                                     {"pixel", GreedyGrid::kPixel},
                                     {"subpixel", GreedyGrid::kSubpixel}},
                                    "cells that the base image starts from")),
               number_option("gamma", &O::gamma, 0.0, 0.526, "caution: larger stops earlier"),
               expert(var_mode_option(&O::var_mode)),
           },
       .views = {{"stop.s", "1 where scale s stops, after the vote"},
                 {"level", "chosen scale; 0: the base image"}},
       .needs =
           [](const GreedySelectionOptions& options) {
             return Needs{.film_positions =
                              options.grid == GreedyGrid::kPixel ? Use::kNone : Use::kWhenRecorded};
           },
       .memory = {284, 2e6},
       .cost = 0.79,
       .run = reconstruct_greedy_selection});
}

}  // namespace spool
