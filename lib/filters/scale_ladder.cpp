#include "lib/filters/scale_ladder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/piece_estimates.h"
#include "lib/filters/truncated_filter.h"

namespace spool {
namespace {

constexpr double kOwnVote = 0.01;
constexpr double kLeastSamples = 1.0001;  // N <= 1 would give z = 0: no pixel would ever stop

}  // namespace

Result<LadderBase> make_ladder_base(const PieceStatistics& statistics, const SamplePool& pool,
                                    GreedyGrid grid, const VarianceOptions& options,
                                    double exposure, GuardCounts& guards) {
  const int q = statistics.pieces_per_side;
  const bool film = pool.recording().has_film();
  if (grid == GreedyGrid::kSubpixel && !film) {
    return fail(ErrorCode::kData,
                "{}: gem_grid=subpixel needs film positions, which were not recorded: use pixel",
                pool.recording().name());
  }
  LadderBase base;
  base.subpixel = grid != GreedyGrid::kPixel && film;
  SPOOL_ASSIGN(PieceEstimates pieces, estimate_pieces(statistics, options, exposure, guards));
  base.count = Plane(pieces.n.width(), pieces.n.height());
  for (std::size_t i = 0; i < base.count.size(); ++i)
    base.count[i] = pieces.n[i] * q * q;
  base.count = average_pieces(base.count, q);
  const RgbImage mean = average_pieces(std::move(pieces.mean), q);
  base.variance = average_piece_variance(std::move(pieces.variance), q);
  const PixelKernel kernel = compose_with_base({0, {1.0}}, base.subpixel);
  const RgbImage cells = base.subpixel ? cell_means(statistics, pool, mean) : RgbImage{};
  for (std::size_t c = 0; c < 3; ++c) {
    base.image[c] = base.subpixel ? filter_cells(cells[c]) : truncated_mean(mean[c], kernel.taps);
  }
  return base;
}

Scale base_scale(const LadderBase& base) {
  const PixelKernel kernel = compose_with_base({0, {1.0}}, base.subpixel);
  Scale scale;
  scale.image = base.image;
  for (std::size_t c = 0; c < 3; ++c)
    scale.variance[c] = truncated_variance(base.variance[c], kernel.taps, kernel.squares);
  scale.samples = truncated_sum(base.count, peak_normalised(kernel.taps));
  return scale;
}

Scale scale_at(const LadderBase& base, const Scale& lowest, int s, double sigma) {
  const Taps gaussian = floor_gaussian_taps(sigma);
  const PixelKernel kernel = compose_with_base(gaussian, base.subpixel);
  Scale scale;
  for (std::size_t c = 0; c < 3; ++c) {
    scale.image[c] = truncated_mean(base.image[c], gaussian);
    scale.variance[c] = truncated_variance(base.variance[c], kernel.taps, kernel.squares);
  }
  scale.samples = s == 1 ? lowest.samples : truncated_mean(base.count, kernel.taps);
  return scale;
}

double transition_beta(int s, double sigma, double before) {
  if (s == 1) return 1.0;
  return (sigma * sigma + before * before) / (sigma * sigma - before * before);
}

double transition_caution(double gamma) {
  return -std::log(1.0 - std::pow(1.9 * gamma, 1.0 / std::numbers::sqrt2));
}

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

Plane neighbour_votes(const Plane& stop, double sigma) {
  const Taps taps = convolved_taps(floor_gaussian_taps(sigma), pixel_filter_taps());
  Plane votes = truncated_mean(stop, taps);
  // Weight of the pixel itself: the centre tap over the taps inside, in x and in y.
  const Plane inside = truncated_sum_of_ones(stop.width(), stop.height(), taps);
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  parallel_rows(0, stop.height(), [&](int y) {
    for (int x = 0; x < stop.width(); ++x) {
      const double excess = std::max(0.0, middle * middle / inside(x, y) - kOwnVote);
      // A lone pixel has no neighbours to ask.
      votes(x, y) =
          excess < 1.0 - kOwnVote ? (votes(x, y) - excess * stop(x, y)) / (1.0 - excess) : 1.0;
    }
  });
  return votes;
}

}  // namespace spool
