#include "lib/sampling/cross_bilateral.h"

#include <algorithm>

#include "lib/sampling/rounds.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 1e-2;  // in squared units of the exposed radiance

}  // namespace

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
  SPOOL_CHECK_GE(budget, 0);
  SamplingLog log;
  log.budget = budget;
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  PieceStatistics statistics =
      prefix_statistics(pool, initial_counts(pool, budget, each, context.seed));
  log.initial = count_samples(statistics.n);
  expose(statistics, pool, options.filter.key, log.guards);
  const long long left = std::min(budget, pool.total_capacity()) - log.initial;
  for (const long long share : equal_shares(left, options.iterations)) {
    if (share == 0) continue;
    GuardCounts guards;  // of copies; what decides here and nowhere else is counted, each round
    SPOOL_ASSIGN(const Plane density,
                 cross_bilateral_density(statistics, pool, options.filter, guards));
    for (const Guard decides : {Guard::kNegativeError, Guard::kFeatureNotFinite})
      log.guards.add(decides, guards[decides]);
    if (context.views != nullptr) context.views->add_next("density", density);
    take_extra(statistics, pool, hand_out(density, statistics.n, pool, share));
    SPOOL_TRY(report_progress(context, "cross_bilateral", count_samples(statistics.n), budget));
  }
  return finished(std::move(log), std::move(statistics), pool);
}

}  // namespace spool
