#include "lib/sampling/denoised_variance.h"

#include <algorithm>
#include <cmath>

#include "lib/kernels/denoised_variance.h"
#include "lib/sampling/filter_disagreement.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {

const OptionTable<DenoisedVarianceOptions>& denoised_variance_option_table() {
  using O = DenoisedVarianceOptions;
  static const OptionTable<O> table = {
      init_spp_option(&O::init_spp),
      integer_option<O>("rounds", &O::rounds, 1, 1000, "rounds that share the rest"),
      choice_option<O, bool>("source", &O::denoised, {{"denoised", true}, {"noisy", false}},
                             "variances of neighbourhoods, or each piece's own"),
  };
  return table;
}

Result<Plane> sample_deviation(const PieceStatistics& statistics, const SamplePool& pool,
                               const DenoisedVarianceOptions& options, GuardCounts& guards) {
  const CountImage& n = statistics.n;
  const double unit = std::ldexp(1.0, std::ilogb(statistics.signal.exposure));
  SampleVariances variances = sample_variances(
      transformed_moments(pool, n, unit, 1.0, HighestMoment::kFourth), n, pool.pieces_per_side());
  if (options.denoised) {
    SPOOL_ASSIGN(const PairFeatures features, pair_features(pool, n, options.features, guards));
    variances.value = denoised_variance(variances, features, float_counts(n), options.window);
  }
  Plane deviation(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i) {
    const RgbImage& s2 = variances.value;
    deviation[i] = std::sqrt((s2[0][i] + s2[1][i] + s2[2][i]) / 3.0);
  }
  return deviation;
}

Result<SamplingResult> sample_denoised_variance(const SamplePool& pool, long long budget,
                                                const DenoisedVarianceOptions& options,
                                                const SamplingContext& context) {
  // Variances require two samples.
  const int each = options.init_spp.value_or(std::max(2, default_initial_samples(budget, pool)));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const auto choose = [&](long long share) -> Result<CountImage> {
    SPOOL_ASSIGN(const Plane deviation,
                 sample_deviation(spending.statistics, pool, options, spending.log.guards));
    if (context.views != nullptr) context.views->add_next("deviation", deviation);
    if (!decide(deviation)) return CountImage();
    return hand_out_deficits(deviation, spending.statistics.n, pool, share);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.rounds, "denoised_variance", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler denoised_variance_sampler() {
  return make_value<SamplerFunction, DenoisedVarianceOptions>(
      {.name = "denoised_variance",
       .summary = "where samples deviate most, by variances averaged over like neighbours",
       .source = Source::kDescriptions,
       .options = denoised_variance_option_table(),
       .views = {{"deviation.i", "deviation of a piece's samples, round i"}},
       .needs =
           [](const auto& options) {
             return Needs{.features = options.denoised ? Use::kWhenRecorded : Use::kNone};
           },
       .memory = {334, 4e6},
       .cost = 9.2,
       .run = sample_denoised_variance});
}

}  // namespace spool
