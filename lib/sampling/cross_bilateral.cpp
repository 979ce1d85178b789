#include "lib/sampling/cross_bilateral.h"

#include <algorithm>

#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 1e-2;  // in squared units of the exposed radiance

const OptionTable<CrossBilateralSamplingOptions>& cross_bilateral_sampling_option_table() {
  using O = CrossBilateralSamplingOptions;
  static const OptionTable<O> table = [] {
    OptionTable<O> options = {
        init_spp_option<O>(&O::init_spp),
        integer_option<O>("iterations", &O::iterations, 1, 1000, "iterations that share the rest"),
    };
    append_options(options, cross_bilateral_option_table(), &O::filter);
    return options;
  }();
  return table;
}

}  // namespace

Result<Plane> cross_bilateral_density(const PieceStatistics& statistics, const SamplePool& pool,
                                      const CrossBilateralOptions& options, GuardCounts& guards) {
  const double exposure = statistics.signal.exposure;
  SPOOL_ASSIGN(const CrossBilateralImage filtered,
               cross_bilateral(statistics, pool, exposure, options, guards));
  Plane density(statistics.width(), statistics.height());
  for (std::size_t i = 0; i < density.size(); ++i) {
    double square = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double f = exposure * filtered.image[c][i];
      square += f * f / 3.0;
    }
    const double worth = filtered.risk[i] + filtered.variance[i];
    if (worth < 0.0) guards.add(Guard::kNegativeError);
    density[i] = std::max(0.0, worth) / (square + kRelativeFloor) / (1.0 + statistics.n[i]);
  }
  return density;
}

Result<SamplingResult> sample_cross_bilateral(const SamplePool& pool, long long budget,
                                              const CrossBilateralSamplingOptions& options,
                                              const SamplingContext& context) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const auto choose = [&](long long share) -> Result<CountImage> {
    GuardCounts guards;  // of copies; what decides here and nowhere else is counted, each round
    SPOOL_ASSIGN(const Plane density,
                 cross_bilateral_density(spending.statistics, pool, options.filter, guards));
    for (const Guard decides : {Guard::kNegativeError, Guard::kFeatureNotFinite})
      spending.log.guards.add(decides, guards[decides]);
    if (context.views != nullptr) context.views->add_next("density", density);
    if (!decide(density)) return CountImage();
    return hand_out(density, spending.statistics.n, pool, share);
  };
  SPOOL_TRY(
      spend_in_rounds(spending, pool, options.iterations, "cross_bilateral", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler cross_bilateral_sampler() {
  return make_value<SamplerFunction, CrossBilateralSamplingOptions>(
      {.name = "cross_bilateral",
       .summary = "where a filter guided by recorded features expects the largest risk",
       .options = cross_bilateral_sampling_option_table(),
       .views = {{"density.i", "what iteration i is apportioned over"}},
       .needs = [](const auto&) { return Needs{.features = Use::kRequired}; },
       .memory = {264, 6.8e6},
       .cost = 14.2,
       .run = sample_cross_bilateral});
}

}  // namespace spool
