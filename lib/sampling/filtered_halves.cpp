#include "lib/sampling/filtered_halves.h"

#include <algorithm>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 0.01;  // in squared units of the exposed radiance

Plane filtered_difference(const RgbImage& a, const RgbImage& b, double exposure) {
  Plane error(a[0].width(), a[0].height());
  parallel_rows(0, error.height(), [&](int y) {
    for (int x = 0; x < error.width(); ++x) {
      double sum = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double fa = exposure * a[c](x, y), fb = exposure * b[c](x, y);
        const double f = 0.5 * (fa + fb);
        sum += (fa - fb) * (fa - fb) / (f * f + kRelativeFloor);
      }
      error(x, y) = sum / 3.0;
    }
  });
  return error;
}

}  // namespace

const OptionTable<FilteredHalvesOptions>& filtered_halves_option_table() {
  using O = FilteredHalvesOptions;
  static const OptionTable<O> table = {
      integer_option<O>("rounds", &O::rounds, 1, 1000, "rounds that share the rest"),
  };
  return table;
}

PieceStatistics half_statistics(const PieceStatistics& statistics, const SamplePool& half_pool,
                                int parity) {
  CountImage n = statistics.n;
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] = (n[i] + 1 - parity) / 2;
  return prefix_statistics(half_pool, n, statistics.signal);
}

CountImage hand_out_deficits(const Plane& weight, const CountImage& n, const SamplePool& pool,
                             long long share) {
  const double sum = pairwise_sum(weight.size(), [&](std::size_t i) { return weight[i]; });
  const auto all = static_cast<double>(count_samples(n) + share);
  Plane deficit(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double worth = sum > 0.0 ? weight[i] / sum * all : 0.0;
    deficit[i] = std::max(worth - n[i], 0.0);
  }
  return hand_out(deficit, n, pool, share);
}

Plane pixels_to_pieces(const Plane& pixels, int pieces_per_side) {
  const int q = pieces_per_side;
  Plane pieces(pixels.width() * q, pixels.height() * q);
  for (int y = 0; y < pieces.height(); ++y) {
    for (int x = 0; x < pieces.width(); ++x)
      pieces(x, y) = pixels(x / q, y / q) / (q * q);
  }
  return pieces;
}

Result<SamplingResult> sample_filtered_halves(const SamplePool& pool, long long budget,
                                              const FilteredHalvesOptions& options,
                                              const SamplingContext& context) {
  if (!context.filter) {
    return fail(ErrorCode::kUsage,
                "sampler filtered_halves: needs the filter of the final image in its loop: name "
                "it with --filter");
  }
  const long long pieces = static_cast<long long>(pool.width()) * pool.height();
  const auto start = std::llround(options.start * static_cast<double>(budget));
  const long long first = std::min(budget, std::max(start, 2 * pieces));
  Spending spending = begin_spending(
      pool, budget, initial_counts(pool, first, std::numeric_limits<int>::max(), context.seed));

  const std::array<SamplePool, 2> halves = {pool.half(0), pool.half(1)};
  const auto choose = [&](long long share) -> Result<CountImage> {
    const PieceStatistics& statistics = spending.statistics;
    std::array<RgbImage, 2> filtered;
    for (int parity = 0; parity < 2; ++parity) {
      const auto i = static_cast<std::size_t>(parity);
      Selection half;
      half.statistics = half_statistics(statistics, halves[i], parity);
      SPOOL_ASSIGN(filtered[i], context.filter(half, halves[i]));
    }
    Plane weight = filtered_difference(filtered[0], filtered[1], statistics.signal.exposure);
    if (context.views != nullptr) context.views->add_next("error", weight);
    weight = gaussian_blur(weight, options.blur);
    for (double& value : weight.pixels())
      value = std::sqrt(std::max(value, 0.0));
    return hand_out_deficits(pixels_to_pieces(weight, pool.pieces_per_side()), statistics.n, pool,
                             share);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.rounds, "filtered_halves", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler filtered_halves_sampler() {
  return make_value<SamplerFunction, FilteredHalvesOptions>(
      {.name = "filtered_halves",
       .summary = "where the filter in the loop disagrees on two halves of the samples",
       .options = filtered_halves_option_table(),
       .views = {{"error.i", "relative difference of the two filtered halves, round i"}},
       .needs = [](const auto&) { return Needs{.filter_in_loop = true}; },
       .memory = {128, 2e6},
       .run = sample_filtered_halves});
}

}  // namespace spool
