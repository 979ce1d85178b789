#include "lib/reconstruction/greedy_selection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/core/parallel.h"
#include "lib/reconstruction/piece_estimates.h"
#include "lib/reconstruction/pixel_base.h"
#include "lib/reconstruction/truncated_filter.h"
#include "lib/reconstruction/variance_option.h"

namespace spool {
namespace {

constexpr double kOwnVote = 0.01;
constexpr double kLeastSamples = 1.0001;  // N <= 1 would give z = 0: no pixel would ever stop

// Everything known at one scale.
struct Scale {
  RgbImage image, variance;
  Plane samples;  // N of the transition to this scale
};

// stop_s of every pixel, before and after the vote of its neighbours.
Plane transition_stops(const Scale& fine, const Scale& coarse, double beta, double caution) {
  Plane stop(fine.samples.width(), fine.samples.height());
  parallel_rows(0, stop.height(), [&](int y) {
    for (int x = 0; x < stop.width(); ++x) {
      const double z = caution * (1.0 - 1.0 / std::max(coarse.samples(x, y), kLeastSamples));
      double balance = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double step = coarse.image[c](x, y) - fine.image[c](x, y);
        const double gain = fine.variance[c](x, y) - coarse.variance[c](x, y);
        balance += z * beta * step * step - gain;
      }
      stop(x, y) = balance >= 0.0 ? 1.0 : 0.0;
    }
  });
  return stop;
}

void open_stops(Plane& stop, double sigma) {
  const Taps taps = convolved_taps(floor_gaussian_taps(sigma), pixel_filter_taps());
  const Plane vote = truncated_mean(stop, taps);
  // Weight of the pixel itself: the centre tap over the taps inside, in x and in y.
  Plane own(stop.width(), stop.height(), 0.0);
  const Plane inside = truncated_sum(Plane(stop.width(), stop.height(), 1.0), taps);
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  parallel_rows(0, stop.height(), [&](int y) {
    for (int x = 0; x < stop.width(); ++x) {
      const double excess = std::max(0.0, middle * middle / inside(x, y) - kOwnVote);
      // A lone pixel has no neighbours to ask.
      const double others =
          excess < 1.0 - kOwnVote ? (vote(x, y) - excess * stop(x, y)) / (1.0 - excess) : 1.0;
      if (std::floor(others + 0.5 + 1e-9) < 1.0) stop(x, y) = 0.0;
    }
  });
}

}  // namespace

double greedy_scale(int s) {
  return std::pow(2.0, 0.5 * (s - 2));
}

OptionTable<GreedySelectionOptions> greedy_selection_option_table() {
  using O = GreedySelectionOptions;
  return {
      choice_option<O, GreedyGrid>("gem_grid", &O::grid,
                                   {{"auto", GreedyGrid::kAuto},
                                    {"pixel", GreedyGrid::kPixel},
                                    {"subpixel", GreedyGrid::kSubpixel}},
                                   "cells that the base image starts from"),
      integer_option<O>("scales", &O::scales, 1, 16, "Gaussians above the base image"),
      number_option<O>("gamma", &O::gamma, 0.0, 0.526, "caution: larger stops earlier"),
      number_option<O>("alpha", &O::alpha, 0.0, 8.0, "blur of the stop maps, in units of sigma"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6,
                       "mean luminance that the floor of the variance is written for"),
  };
}

Result<Reconstruction> reconstruct_greedy_selection(const Selection& selection,
                                                    const SamplePool& pool,
                                                    const ReconstructionContext& context,
                                                    const GreedySelectionOptions& options) {
  const PieceStatistics& statistics = selection.statistics;
  const int q = statistics.pieces_per_side;
  const bool film = pool.recording().has_film();
  Reconstruction result;
  if (options.grid == GreedyGrid::kSubpixel && !film) {
    return fail(ErrorCode::kData,
                "{}: gem_grid=subpixel needs film positions, which were not recorded: use pixel",
                pool.recording().name());
  }
  const bool subpixel = options.grid != GreedyGrid::kPixel && film;
  const double exposure = analysis_exposure(statistics, options.key, true, result.guards);
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(statistics, {options.var_mode, options.nu0, options.key}, exposure,
                               result.guards));
  Plane count(pieces.n.width(), pieces.n.height());
  for (std::size_t i = 0; i < count.size(); ++i)
    count[i] = pieces.n[i] * q * q;
  count = average_pieces(count, q);
  const RgbImage mean = average_pieces(std::move(pieces.mean), q);
  const RgbImage variance = average_piece_variance(std::move(pieces.variance), q);
  const int width = count.width(), height = count.height();

  // Base image
  Scale fine;
  const PixelKernel base = compose_with_base({0, {1.0}}, subpixel);
  const RgbImage cells = subpixel ? cell_means(statistics, pool, mean) : RgbImage{};
  for (std::size_t c = 0; c < 3; ++c) {
    fine.image[c] = subpixel ? filter_cells(cells[c]) : truncated_mean(mean[c], base.taps);
    fine.variance[c] = truncated_variance(variance[c], base.taps, base.squares);
  }
  fine.samples = truncated_sum(count, peak_normalised(base.taps));
  const RgbImage base_image = fine.image;

  // One transition after the other; a pixel that has stopped stays where it is
  result.image = fine.image;
  result.variance = fine.variance;
  CountImage level(width, height, 0);
  CountImage stopped(width, height, 0);
  const double caution = -std::log(1.0 - std::pow(1.9 * options.gamma, 1.0 / std::numbers::sqrt2));
  for (int s = 1; s <= options.scales; ++s) {
    const double sigma = greedy_scale(s), before = greedy_scale(s - 1);
    const double beta =
        s == 1 ? 1.0 : (sigma * sigma + before * before) / (sigma * sigma - before * before);
    const Taps gaussian = floor_gaussian_taps(sigma);
    const PixelKernel kernel = compose_with_base(gaussian, subpixel);
    Scale coarse;
    for (std::size_t c = 0; c < 3; ++c) {
      coarse.image[c] = truncated_mean(base_image[c], gaussian);
      coarse.variance[c] = truncated_variance(variance[c], kernel.taps, kernel.squares);
    }
    coarse.samples = s == 1 ? fine.samples : truncated_mean(count, kernel.taps);
    Plane stop = transition_stops(fine, coarse, beta, caution);
    open_stops(stop, options.alpha * sigma);
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (stop[i] > 0.0) stopped[i] = 1;
      if (stopped[i] != 0) continue;
      level[i] = s;
      for (std::size_t c = 0; c < 3; ++c) {
        result.image[c][i] = coarse.image[c][i];
        (*result.variance)[c][i] = coarse.variance[c][i];
      }
    }
    if (context.views) context.views->add(fmt::format("stop.{}", s), stop);
    fine = std::move(coarse);
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

ReconstructorMethod<GreedySelectionOptions> greedy_selection_method() {
  return {"greedy_selection",
          "each pixel's best Gaussian by incremental bias and variance",
          false,
          greedy_selection_option_table(),
          {{"", {}}},
          reconstruct_greedy_selection};
}

}  // namespace spool
