#include "lib/kernels/scale_ladder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/truncated_filter.h"

namespace spool {
namespace {

constexpr double kOwnVote = 0.01;
constexpr double kLeastSamples = 1.0001;  // N <= 1 would give z = 0: no pixel would ever stop

// z loss - gain of a row of a channel.
SPOOL_VECTOR_CLONES
void add_balance(const double* fine, const double* coarse, const double* fine_variance,
                 const double* coarse_variance, const double* samples, double beta, double caution,
                 int width, double* __restrict balance) {
  for (int x = 0; x < width; ++x) {
    const double z = caution * (1.0 - 1.0 / std::max(samples[x], kLeastSamples));
    const double step = coarse[x] - fine[x];
    const double gain = fine_variance[x] - coarse_variance[x];
    balance[x] += z * beta * step * step - gain;
  }
}

// loss - gain of the same.
SPOOL_VECTOR_CLONES
void add_change(const double* fine, const double* coarse, const double* fine_variance,
                const double* coarse_variance, double beta, int width, double* __restrict change) {
  for (int x = 0; x < width; ++x) {
    const double step = coarse[x] - fine[x];
    const double gain = fine_variance[x] - coarse_variance[x];
    change[x] += beta * step * step - gain;
  }
}

}  // namespace

bool uses_cells(GreedyGrid grid, const SamplePool& pool) {
  return grid == GreedyGrid::kSubpixel ||
         (grid == GreedyGrid::kAuto && pool.recording().has_film());
}

Result<LadderBase> make_ladder_base(const PieceStatistics& statistics, const SamplePool& pool,
                                    GreedyGrid grid, const VarianceOptions& options,
                                    double exposure, GuardCounts& guards, KeptImage* before) {
  const int q = statistics.pieces_per_side;
  LadderBase base;
  base.subpixel = uses_cells(grid, pool);
  SPOOL_ASSIGN(PieceEstimates pieces, estimate_pieces(statistics, options, exposure, guards));
  base.count = Plane(pieces.n.width(), pieces.n.height());
  parallel_rows(0, base.count.height(), [&](int y) {
    for (int x = 0; x < base.count.width(); ++x)
      base.count(x, y) = pieces.n(x, y) * q * q;
  });
  if (q > 1) base.count = average_pieces(base.count, q);
  const RgbImage mean = average_pieces(std::move(pieces.mean), q);
  base.variance = average_piece_variance(std::move(pieces.variance), q);
  if (base.subpixel && before != nullptr && !before->n.empty()) {
    base.image = std::move(before->image);
    refilter_cell_means(statistics, pool, mean, before->n, base.image);
  } else if (base.subpixel) {
    base.image = filtered_cell_means(statistics, pool, mean);
  } else {
    const Taps taps = compose_with_base({0, {1.0}}, false).taps;
    for (std::size_t c = 0; c < 3; ++c)
      base.image[c] = truncated_mean(mean[c], taps);
  }
  return base;
}

Scale base_scale(const LadderBase& base) {
  const PixelKernel kernel = compose_with_base({0, {1.0}}, base.subpixel);
  Scale scale;
  for (std::size_t c = 0; c < 3; ++c) {
    scale.channels[c].image = base.image[c];
    scale.channels[c].variance = truncated_variance(base.variance[c], kernel.taps, kernel.squares);
  }
  scale.samples = truncated_sum(base.count, peak_normalised(kernel.taps));
  return scale;
}

double transition_beta(int s, double sigma, double before) {
  if (s == 1) return 1.0;
  return (sigma * sigma + before * before) / (sigma * sigma - before * before);
}

double transition_caution(double gamma) {
  return -std::log(1.0 - std::pow(1.9 * gamma, 1.0 / std::numbers::sqrt2));
}

void add_transition(const ScaleChannel& fine, const ScaleChannel& coarse, const Plane& samples,
                    double beta, double caution, Plane& balance, Plane* change) {
  parallel_rows(0, balance.height(), [&](int y) {
    const double *from = fine.image.row(y).data(), *to = coarse.image.row(y).data();
    const double *before = fine.variance.row(y).data(), *after = coarse.variance.row(y).data();
    const int width = balance.width();
    add_balance(from, to, before, after, samples.row(y).data(), beta, caution, width,
                balance.row(y).data());
    if (change != nullptr) add_change(from, to, before, after, beta, width, change->row(y).data());
  });
}

Plane climb(Scale& scale, const LadderBase& base, int s, double sigma, double beta, double caution,
            Plane* change) {
  const Taps gaussian = floor_gaussian_taps(sigma);
  const PixelKernel kernel = compose_with_base(gaussian, base.subpixel);
  if (s > 1) scale.samples = truncated_mean(base.count, kernel.taps);
  Plane stop(base.count.width(), base.count.height());
  if (change != nullptr) *change = stop;
  for (std::size_t c = 0; c < 3; ++c) {
    ScaleChannel coarse{truncated_mean(base.image[c], gaussian),
                        truncated_variance(base.variance[c], kernel.taps, kernel.squares)};
    add_transition(scale.channels[c], coarse, scale.samples, beta, caution, stop, change);
    scale.channels[c] = std::move(coarse);
  }
  parallel_rows(0, stop.height(), [&](int y) {
    for (double& balance : stop.row(y))
      balance = balance >= 0.0 ? 1.0 : 0.0;
  });
  return stop;
}

Plane neighbour_votes(const Plane& stop, double sigma) {
  const Taps taps = convolved_taps(floor_gaussian_taps(sigma), pixel_filter_taps());
  Plane votes = truncated_mean(stop, taps);
  // Weight of the pixel itself: the centre tap over the taps inside, in x and in y.
  const TapsInside inside(stop.width(), stop.height(), taps);
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  parallel_rows(0, stop.height(), [&](int y) {
    std::vector<double> memory;
    const std::vector<double>& of_row = inside.row(y, memory);
    for (int x = 0; x < stop.width(); ++x) {
      const double of_taps = of_row[static_cast<std::size_t>(x)];
      const double excess = std::max(0.0, middle * middle / of_taps - kOwnVote);
      // A lone pixel has no neighbours to ask.
      votes(x, y) =
          excess < 1.0 - kOwnVote ? (votes(x, y) - excess * stop(x, y)) / (1.0 - excess) : 1.0;
    }
  });
  return votes;
}

}  // namespace spool
