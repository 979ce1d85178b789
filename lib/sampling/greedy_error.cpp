#include "lib/sampling/greedy_error.h"

#include <algorithm>
#include <cmath>

#include "lib/core/random.h"
#include "lib/sampling/greedy_placement.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {

Result<SamplingResult> sample_greedy_error(const SamplePool& pool, long long budget,
                                           const GreedyErrorOptions& options,
                                           const SamplingContext& context) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const long long pixels =
      static_cast<long long>(pool.recording().width()) * pool.recording().height();
  const double average = static_cast<double>(budget) / static_cast<double>(pixels);
  const long long per_pixel = std::max(1LL, std::llround(average));
  std::uint64_t iteration = 0;
  KeptImage kept;
  const auto choose = [&](long long share) -> Result<CountImage> {
    SPOOL_ASSIGN(const GreedyErrorMap map, greedy_error_map(spending.statistics, pool, average,
                                                            options, spending.log.guards, &kept));
    if (context.views != nullptr) context.views->add_next("error", map.error);
    return hand_out_greedily(map, spending.statistics, pool, share, per_pixel,
                             mix(context.seed, iteration++), options);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.iterations, "greedy_error", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler greedy_error_sampler() {
  return make_value<SamplerFunction, GreedyErrorOptions>(
      {.name = "greedy_error",
       .summary = "where each pixel's best Gaussian still has the largest relative error",
       .options = greedy_error_option_table(),
       .views = {{"error.i", "relative error that more samples remove, iteration i"}},
       .needs =
           [](const GreedyErrorOptions& options) {
             return Needs{.film_positions =
                              options.grid == GreedyGrid::kPixel ? Use::kNone : Use::kWhenRecorded};
           },
       .memory = {260, 2e6},
       .cost = 4.8,
       .run = sample_greedy_error});
}

}  // namespace spool
