#include "lib/sampling/greedy_error_map.h"

#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/sampling/rounds.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

// Squared exposed radiance. The publication has 1e-3 for pictures whose whites are near 1; their
// mean luminance, 1 when exposed, is about 0.1, in recordings here 0.1 to 0.4.
constexpr double kRelativeFloor = 1e-3 / (0.1 * 0.1);

}  // namespace

const OptionTable<GreedyErrorOptions>& greedy_error_option_table() {
  using O = GreedyErrorOptions;
  static const OptionTable<O> table = {
      init_spp_option<O>(&O::init_spp),
      integer_option<O>("iterations", &O::iterations, 1, 1000, "iterations that share the rest"),
      number_option<O>("gamma", &O::gamma, 0.0, 0.526, "caution: larger stops earlier"),
      expert(choice_option<O, GreedyGrid>("grid", &O::grid,
                                          {{"auto", GreedyGrid::kAuto},
                                           {"pixel", GreedyGrid::kPixel},
                                           {"subpixel", GreedyGrid::kSubpixel}},
                                          "cells that the base image starts from")),
      expert(var_mode_option(&O::var_mode)),
  };
  return table;
}

Result<GreedyErrorMap> greedy_error_map(const PieceStatistics& statistics, const SamplePool& pool,
                                        double per_pixel, const GreedyErrorOptions& options,
                                        GuardCounts& guards, KeptImage* kept) {
  const double exposure = statistics.signal.exposure;
  SPOOL_ASSIGN(LadderBase base, make_ladder_base(statistics, pool, options.grid, {options.var_mode},
                                                 exposure, guards, kept));
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
  // body(i, guards of the row) for every pixel i.
  const auto for_pixels = [&](const auto& body) {
    std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
    parallel_rows(0, height, [&](int y) {
      for (std::size_t i = mse.index(0, y); i < mse.index(0, y + 1); ++i)
        body(i, caught[static_cast<std::size_t>(y)]);
    });
    for (const GuardCounts& row : caught)
      guards += row;
  };
  for_pixels([&](std::size_t i, GuardCounts& caught) {
    const auto& [red, green, blue] = scale.channels;
    mse[i] = (red.variance[i] + green.variance[i] + blue.variance[i]) / 3.0;
    map.error[i] = relative(mse[i], scale.samples[i], i, caught);
  });
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
    for_pixels([&](std::size_t i, GuardCounts& caught) {
      mse[i] += change[i] / 3.0;
      if (map.scale[i] < s - 1 || votes_to_stop(votes[i])) return;
      map.scale[i] = s;
      map.error[i] = relative(mse[i], samples[i], i, caught);
    });
  }
  if (kept != nullptr && base.subpixel) *kept = {statistics.n, std::move(base.image)};
  return map;
}

}  // namespace spool
