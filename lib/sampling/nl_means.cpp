#include "lib/sampling/nl_means.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "lib/pyramid/convolution.h"
#include "lib/sampling/apportion.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

// Squared exposed radiance; see lib/sampling/greedy_error_map.cpp.
constexpr double kRelativeFloor = 1e-3 / (0.1 * 0.1);
constexpr double kBlur = 0.8;         // sigma of the smoothing of the error, pieces
constexpr double kLeastCount = 1e-3;  // a half without samples near a pixel

// Apportions `share` over `error`, no piece beyond `most` in this iteration nor beyond its pool;
// what that leaves over goes by room in the pool alone.
CountImage hand_out_limited(const Plane& error, const CountImage& n, const SamplePool& pool,
                            long long share, long long most) {
  std::vector<long long> room = room_of(n, pool);
  for (long long& of_piece : room)
    of_piece = std::min(of_piece, most);
  const std::vector<long long> given = apportion(error.pixels(), share, room);
  CountImage extra(n.width(), n.height()), reached = n;
  for (std::size_t i = 0; i < n.size(); ++i) {
    extra[i] = static_cast<std::int32_t>(given[i]);
    reached[i] += extra[i];
    share -= given[i];
  }
  const CountImage rest = hand_out(error, reached, pool, share);
  for (std::size_t i = 0; i < n.size(); ++i)
    extra[i] += rest[i];
  return extra;
}

const OptionTable<NlMeansSamplingOptions>& nl_means_sampling_option_table() {
  using O = NlMeansSamplingOptions;
  static const OptionTable<O> table = [] {
    OptionTable<O> options = {
        integer_or_word_option<O>(
            "init_spp", &O::init_spp, "auto", 2, 65535,
            "samples that every piece takes first; auto: 4 from 8 samples per piece on, else 2"),
        integer_option<O>("iterations", &O::iterations, 1, 1000, "iterations that share the rest"),
    };
    append_options(options, patch_filter_option_table(), &O::filter);
    options.push_back(expert(half_variance_option(&O::var_mode)));
    return options;
  }();
  return table;
}

}  // namespace

Result<Plane> nl_means_error(const std::array<HalfSums, 2>& halves,
                             const PieceStatistics& statistics,
                             const NlMeansSamplingOptions& options, GuardCounts& guards) {
  std::array<HalfImage, 2> images;
  std::array<Plane, 2> counts;
  for (std::size_t h = 0; h < 2; ++h) {
    SPOOL_ASSIGN(SampleHalf half,
                 sample_half(halves[h], statistics, options.var_mode, statistics.signal.exposure));
    images[h] = std::move(half.image);
    counts[h] = Plane(statistics.width(), statistics.height());
    for (std::size_t i = 0; i < half.n.size(); ++i)
      counts[h][i] = half.n[i];
  }
  // Red, green, blue and the sample count of each half, with the other's weights.
  std::array<GuidedTargets, 2> guided;
  for (std::size_t h = 0; h < 2; ++h) {
    const RgbImage& mean = images[h].mean;
    guided[h] = {{&mean[0], &mean[1], &mean[2], &counts[h]}, &images[1 - h]};
  }
  Plane error(statistics.width(), statistics.height());
  std::atomic<std::uint64_t> sparse{0};  // a whole number: the order of its additions is no matter
  filter_tiles(guided, options.filter, [&](const Rectangle& tile, const auto& filtered) {
    std::uint64_t sparse_here = 0;
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const auto of_half = [&](std::size_t h, std::size_t i) {
          return filtered[h][i](x - tile.x0, y - tile.y0);
        };
        for (std::size_t h = 0; h < 2; ++h) {
          double sum = 0.0;
          for (std::size_t c = 0; c < 3; ++c) {
            const double difference = of_half(0, c) - of_half(1, c), value = of_half(h, c);
            sum += 2.0 * difference * difference / (kRelativeFloor + value * value);
          }
          double samples = of_half(h, 3);
          if (samples < kLeastCount) {
            ++sparse_here;
            samples = kLeastCount;
          }
          error(x, y) += sum / 3.0 / samples;
        }
      }
    }
    sparse += sparse_here;
  });
  guards.add(Guard::kSparseHalf, sparse);
  return error;
}

std::array<HalfSums, 2> empty_halves(const SamplePool& pool,
                                     const NlMeansSamplingOptions& options) {
  return {empty_half(pool.width(), pool.height(), 0, options.var_mode),
          empty_half(pool.width(), pool.height(), 1, options.var_mode)};
}

Result<SamplingResult> sample_nl_means(const SamplePool& pool, long long budget,
                                       const NlMeansSamplingOptions& options,
                                       const SamplingContext& context) {
  // Both halves require a sample.
  const int each = options.init_spp.value_or(std::max(2, default_initial_samples(budget, pool)));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const long long pieces = static_cast<long long>(pool.width()) * pool.height();
  const long long most = std::max(1LL, budget / pieces);
  std::array<HalfSums, 2> halves = empty_halves(pool, options);
  const auto choose = [&](long long share) -> Result<CountImage> {
    for (HalfSums& half : halves)
      take_up_to(spending.statistics.n, pool, half);
    SPOOL_ASSIGN(Plane error,
                 nl_means_error(halves, spending.statistics, options, spending.log.guards));
    if (context.views != nullptr) context.views->add_next("error", error);
    if (!decide(error)) return CountImage();
    error = gaussian_blur(error, kBlur);
    return hand_out_limited(error, spending.statistics.n, pool, share, most);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.iterations, "nl_means", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler nl_means_sampler() {
  return make_value<SamplerFunction, NlMeansSamplingOptions>(
      {.name = "nl_means",
       .summary = "where NL-means disagrees on two halves of the samples",
       .options = nl_means_sampling_option_table(),
       .views = {{"error.i", "error before its smoothing, iteration i"}},
       .memory = {274, 4.7e6},
       .cost = 10,
       .run = sample_nl_means});
}

}  // namespace spool
