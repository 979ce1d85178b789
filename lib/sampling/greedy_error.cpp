#include "lib/sampling/greedy_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/filters/truncated_filter.h"
#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/uniform.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 1e-3;  // in squared units of the exposed radiance
constexpr int kRedraws = 16;

// Draws whole offsets with the probabilities of a kernel's taps.
class OffsetDraw {
 public:
  explicit OffsetDraw(const Taps& taps) : first_(taps.first) {
    double sum = 0.0;
    for (const double tap : taps.values)
      cumulative_.push_back(sum += std::max(tap, 0.0));
  }
  int operator()(std::uint64_t bits) const {
    const double at = unit_double(bits) * cumulative_.back();
    const auto it = std::upper_bound(cumulative_.begin(), cumulative_.end(), at);
    const auto i = std::min<std::ptrdiff_t>(it - cumulative_.begin(),
                                            static_cast<std::ptrdiff_t>(cumulative_.size()) - 1);
    return first_ + static_cast<int>(i);
  }

 private:
  int first_;
  std::vector<double> cumulative_;
};

// Counts that grow while an iteration hands its samples out; a pixel offers what its pieces have.
class Offer {
 public:
  Offer(const SamplePool& pool, const CountImage& n)
      : pool_(pool), extra_(n.width(), n.height()), n_(n) {}

  // Gives a sample to the least-sampled unsaturated piece of a pixel; false when it has none.
  bool give(int x, int y) {
    const int q = pool_.pieces_per_side();
    std::optional<std::size_t> best;
    for (int py = y * q; py < (y + 1) * q; ++py) {
      for (int px = x * q; px < (x + 1) * q; ++px) {
        const std::size_t i = n_.index(px, py);
        if (n_[i] + extra_[i] >= pool_.capacity(px, py)) continue;
        if (!best || n_[i] + extra_[i] < n_[*best] + extra_[*best]) best = i;
      }
    }
    if (best) ++extra_[*best];
    return best.has_value();
  }
  CountImage& extra() { return extra_; }

 private:
  const SamplePool& pool_;
  CountImage extra_;
  const CountImage& n_;
};

// The nearest pixel within `reach` that can give a sample: rings of growing Chebyshev radius,
// inside a ring the smallest Euclidean distance, then the lowest index.
bool give_nearby(Offer& offer, int x, int y, int reach, const Rectangle& bounds) {
  for (int radius = 1; radius <= reach; ++radius) {
    std::vector<std::array<int, 3>> ring;  // squared distance, y, x
    for (int dy = -radius; dy <= radius; ++dy) {
      const bool edge = std::abs(dy) == radius;
      for (int dx = -radius; dx <= radius; dx += edge ? 1 : 2 * radius) {
        if (bounds.contains(x + dx, y + dy)) ring.push_back({dx * dx + dy * dy, y + dy, x + dx});
      }
    }
    std::sort(ring.begin(), ring.end());
    for (const auto& [distance, py, px] : ring) {
      if (offer.give(px, py)) return true;
    }
  }
  return false;
}

// One sample for pixel (x, y), drawn from the kernel of its scale; false when none could be placed.
bool place_sample(Offer& offer, const OffsetDraw& draw, int x, int y, int reach,
                  const Rectangle& bounds, std::uint64_t seed) {
  std::uint64_t counter = 0;
  const auto target = [&] {
    while (true) {  // ends: the pixel itself is inside and has the largest tap
      const int tx = x + draw(mix(seed, counter, 0)), ty = y + draw(mix(seed, counter, 1));
      ++counter;
      if (bounds.contains(tx, ty)) return std::array<int, 2>{tx, ty};
    }
  };
  for (int attempt = 0; attempt <= kRedraws; ++attempt) {
    const auto [tx, ty] = target();
    if (offer.give(tx, ty)) return true;
  }
  return offer.give(x, y) || give_nearby(offer, x, y, reach, bounds);
}

// The samples of one iteration.
CountImage hand_out_greedily(const GreedyErrorMap& map, const PieceStatistics& statistics,
                             const SamplePool& pool, const LadderBase& kernels, long long share,
                             long long per_pixel, std::uint64_t seed,
                             const GreedyErrorOptions& options) {
  const Rectangle bounds = map.error.bounds();
  std::vector<OffsetDraw> draws;
  std::vector<int> reach;
  for (int s = 0; s <= options.scales; ++s) {
    const double sigma = s == 0 ? 0.0 : greedy_sampling_scale(s);
    const Taps gaussian = s == 0 ? Taps{0, {1.0}} : floor_gaussian_taps(sigma);
    draws.emplace_back(compose_with_base(gaussian, kernels.subpixel).taps);
    reach.push_back(std::max(1, static_cast<int>(3.0 * sigma)));
  }
  std::vector<std::size_t> order(map.error.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto wanted = std::min<long long>((share + per_pixel - 1) / per_pixel,
                                          static_cast<long long>(order.size()));
  const auto larger = [&](std::size_t a, std::size_t b) {
    return map.error[a] != map.error[b] ? map.error[a] > map.error[b] : a < b;
  };
  std::nth_element(order.begin(), order.begin() + (wanted - 1), order.end(), larger);
  std::sort(order.begin(), order.begin() + wanted, larger);

  Offer offer(pool, statistics.n);
  long long left = share, pot = 0;
  for (long long i = 0; i < wanted; ++i) {
    const std::size_t p = order[static_cast<std::size_t>(i)];
    const int x = static_cast<int>(p) % bounds.x1, y = static_cast<int>(p) / bounds.x1;
    const auto scale = static_cast<std::size_t>(map.scale[p]);
    for (long long j = 0; j < per_pixel && left > 0; ++j, --left) {
      if (!place_sample(offer, draws[scale], x, y, reach[scale], bounds, mix(seed, p, j))) ++pot;
    }
  }
  pot += left;
  CountImage& extra = offer.extra();
  if (pot > 0) {
    CountImage n = statistics.n;
    for (std::size_t i = 0; i < n.size(); ++i)
      n[i] += extra[i];
    const CountImage more =
        hand_out(pixels_to_pieces(map.error, pool.pieces_per_side()), n, pool, pot);
    for (std::size_t i = 0; i < n.size(); ++i)
      extra[i] += more[i];
  }
  return extra;
}

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
  const Scale lowest = base_scale(base);
  GreedyErrorMap map{Plane(width, height), CountImage(width, height)};
  CountImage stopped(width, height);
  Plane mse(width, height);  // of the scale reached so far, whether or not the pixel went on
  const auto relative = [&](const Scale& scale, double squared_error, double samples,
                            std::size_t i) {
    const double value = exposure * (scale.image[0][i] + scale.image[1][i] + scale.image[2][i]) / 3;
    if (squared_error < 0.0) {
      guards.add(Guard::kNegativeError);
      return 0.0;
    }
    return squared_error * exposure * exposure / (kRelativeFloor + value * value) * per_pixel /
           (per_pixel + samples);
  };
  for (std::size_t i = 0; i < mse.size(); ++i) {
    mse[i] = (lowest.variance[0][i] + lowest.variance[1][i] + lowest.variance[2][i]) / 3.0;
    map.error[i] = relative(lowest, mse[i], lowest.samples[i], i);
  }
  Scale fine = lowest;
  const double caution = transition_caution(options.gamma);
  for (int s = 1; s <= options.scales; ++s) {
    const double sigma = greedy_sampling_scale(s);
    const double beta = transition_beta(s, sigma, s == 1 ? 0.0 : greedy_sampling_scale(s - 1));
    Scale coarse = scale_at(base, lowest, s, sigma);
    const Plane votes =
        neighbour_votes(transition_stops(fine, coarse, beta, caution), options.alpha * sigma);
    // Nsum of this scale: samples under its peak-normalised kernel.
    const Taps taps = compose_with_base(floor_gaussian_taps(sigma), base.subpixel).taps;
    const Plane samples = truncated_sum(base.count, peak_normalised(taps));
    parallel_rows(0, height, [&](int y) {
      for (std::size_t i = mse.index(0, y); i < mse.index(0, y + 1); ++i) {
        double change = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          const double step = coarse.image[c][i] - fine.image[c][i];
          change += beta * step * step - (fine.variance[c][i] - coarse.variance[c][i]);
        }
        mse[i] += change / 3.0;
        if (votes_to_stop(votes[i])) stopped[i] = 1;
        if (stopped[i] != 0) continue;
        map.scale[i] = s;
        map.error[i] = relative(coarse, mse[i], samples[i], i);
      }
    });
    fine = std::move(coarse);
  }
  return map;
}

Result<SamplingResult> sample_greedy_error(const SamplePool& pool, long long budget,
                                           const GreedyErrorOptions& options,
                                           const SamplingContext& context) {
  SPOOL_CHECK_GE(budget, 0);
  SamplingLog log;
  log.budget = budget;
  PieceStatistics statistics =
      prefix_statistics(pool, initial_counts(pool, budget, options.init_spp, context.seed));
  log.initial = count_samples(statistics.n);
  expose(statistics, pool, options.key, log.guards);
  const long long pixels =
      static_cast<long long>(pool.recording().width()) * pool.recording().height();
  const double average = static_cast<double>(budget) / static_cast<double>(pixels);
  const long long per_pixel = std::max(1LL, std::llround(average));
  LadderBase kernels;
  kernels.subpixel = options.grid != GreedyGrid::kPixel && pool.recording().has_film();

  const long long left = std::min(budget, pool.total_capacity()) - log.initial;
  std::uint64_t iteration = 0;
  for (const long long share : equal_shares(left, options.iterations)) {
    if (share == 0) continue;
    SPOOL_ASSIGN(const GreedyErrorMap map,
                 greedy_error_map(statistics, pool, average, options, log.guards));
    if (context.views != nullptr) context.views->add_next("error", map.error);
    take_extra(statistics, pool,
               hand_out_greedily(map, statistics, pool, kernels, share, per_pixel,
                                 mix(context.seed, iteration++), options));
    SPOOL_TRY(report_progress(context, "greedy_error", count_samples(statistics.n), budget));
  }
  return finished(std::move(log), std::move(statistics), pool);
}

}  // namespace spool
