#include "lib/sampling/greedy_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/sampling/greedy_placement.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 1e-3;  // in squared units of the exposed radiance

}  // namespace

const OptionTable<GreedyErrorOptions>& greedy_error_option_table() {
  using O = GreedyErrorOptions;
  static const OptionTable<O> table = {
      integer_option<O>("gem_init", &O::init_spp, 1, 65535, "samples that every piece takes first"),
      integer_option<O>("gem_iters", &O::iterations, 1, 1000, "iterations that share the rest"),
      integer_option<O>("scales", &O::scales, 1, 8, "Gaussians above the base image: 1, 2, 4 .."),
      number_option<O>("gamma", &O::gamma, 0.0, 0.526, "caution: larger stops earlier"),
      number_option<O>("alpha", &O::alpha, 0.0, 8.0, "blur of the stop maps, in units of sigma"),
      choice_option<O, GreedyGrid>("gem_grid", &O::grid,
                                   {{"auto", GreedyGrid::kAuto},
                                    {"pixel", GreedyGrid::kPixel},
                                    {"subpixel", GreedyGrid::kSubpixel}},
                                   "cells that the base image starts from"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the normalised luminance"),
  };
  return table;
}

Result<GreedyErrorMap> greedy_error_map(const PieceStatistics& statistics, const SamplePool& pool,
                                        double per_pixel, const GreedyErrorOptions& options,
                                        GuardCounts& guards) {
  const double exposure = statistics.signal.exposure;
  SPOOL_ASSIGN(const LadderBase base,
               make_ladder_base(statistics, pool, options.grid,
                                {options.var_mode, options.nu0, options.key}, exposure, guards));
  const int width = base.count.width(), height = base.count.height();
  Scale scale = base_scale(base);
  GreedyErrorMap map{Plane(width, height), CountImage(width, height)};
  Plane mse(width, height);  // of the scale reached so far, whether or not the pixel went on
  const auto relative = [&](double squared_error, double samples, std::size_t i,
                            GuardCounts& caught) {
    const auto& [red, green, blue] = scale.channels;
    const double value = exposure * (red.image[i] + green.image[i] + blue.image[i]) / 3;
    if (squared_error < 0.0) {
      caught.add(Guard::kNegativeError);
      return 0.0;
    }
    return squared_error * exposure * exposure / (kRelativeFloor + value * value) * per_pixel /
           (per_pixel + samples);
  };
  for (std::size_t i = 0; i < mse.size(); ++i) {
    const auto& [red, green, blue] = scale.channels;
    mse[i] = (red.variance[i] + green.variance[i] + blue.variance[i]) / 3.0;
    map.error[i] = relative(mse[i], scale.samples[i], i, guards);
  }
  const double caution = transition_caution(options.gamma);
  for (int s = 1; s <= options.scales; ++s) {
    const double sigma = greedy_sampling_scale(s);
    const double beta = transition_beta(s, sigma, s == 1 ? 0.0 : greedy_sampling_scale(s - 1));
    Plane change;
    const Plane votes = neighbour_votes(climb(scale, base, s, sigma, beta, caution, &change),
                                        options.alpha * sigma);
    // Nsum of this scale: samples under its peak-normalised kernel.
    const Taps taps = compose_with_base(floor_gaussian_taps(sigma), base.subpixel).taps;
    const Plane samples = truncated_sum(base.count, peak_normalised(taps));
    std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
    parallel_rows(0, height, [&](int y) {
      for (std::size_t i = mse.index(0, y); i < mse.index(0, y + 1); ++i) {
        mse[i] += change[i] / 3.0;
        if (map.scale[i] < s - 1 || votes_to_stop(votes[i])) continue;
        map.scale[i] = s;
        map.error[i] = relative(mse[i], samples[i], i, caught[static_cast<std::size_t>(y)]);
      }
    });
    for (const GuardCounts& row : caught)
      guards += row;
  }
  return map;
}

Result<SamplingResult> sample_greedy_error(const SamplePool& pool, long long budget,
                                           const GreedyErrorOptions& options,
                                           const SamplingContext& context) {
  Spending spending = begin_spending(
      pool, budget, initial_counts(pool, budget, options.init_spp, context.seed), options.key);
  const long long pixels =
      static_cast<long long>(pool.recording().width()) * pool.recording().height();
  const double average = static_cast<double>(budget) / static_cast<double>(pixels);
  const long long per_pixel = std::max(1LL, std::llround(average));
  std::uint64_t iteration = 0;
  const auto choose = [&](long long share) -> Result<CountImage> {
    SPOOL_ASSIGN(const GreedyErrorMap map, greedy_error_map(spending.statistics, pool, average,
                                                            options, spending.log.guards));
    if (context.views != nullptr) context.views->add_next("error", map.error);
    return hand_out_greedily(map, spending.statistics, pool, share, per_pixel,
                             mix(context.seed, iteration++), options);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.iterations, "greedy_error", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler greedy_error_sampler() {
  return make_value<SamplerFunction, GreedyErrorOptions>(
      {.name = "greedy_error",
       .summary = "where each pixel's best Gaussian still has the largest relative error",
       .options = greedy_error_option_table(),
       .views = {{"error.i", "relative error that more samples remove, iteration i"}},
       .needs =
           [](const GreedyErrorOptions& options) {
             return Needs{.film_positions = options.grid == GreedyGrid::kPixel ? Use::kNone
                                            : options.grid == GreedyGrid::kSubpixel
                                                ? Use::kRequired
                                                : Use::kWhenRecorded};
           },
       .memory = {124, 2e6},
       .run = sample_greedy_error});
}

}  // namespace spool
