#include "lib/sampling/filtered_halves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {

Result<SamplingResult> sample_filtered_halves(const SamplePool& pool, long long budget,
                                              const FilteredHalvesOptions& options,
                                              const SamplingContext& context) {
  SPOOL_TRY(check_loop(context, "filtered_halves"));
  const long long pieces = static_cast<long long>(pool.width()) * pool.height();
  const auto start = std::llround(options.start * static_cast<double>(budget));
  const long long first = std::min(budget, std::max(start, 2 * pieces));
  Spending spending = begin_spending(
      pool, budget, initial_counts(pool, first, std::numeric_limits<int>::max(), context.seed));

  const auto choose = [&](long long share) -> Result<CountImage> {
    const PieceStatistics& statistics = spending.statistics;
    Plane error;
    SPOOL_ASSIGN(const Plane weight,
                 filter_disagreement(statistics, pool, context.filter, options.blur, &error));
    if (context.views != nullptr) context.views->add_next("error", error);
    if (!decide(weight)) return CountImage();
    return hand_out_deficits(pixels_to_pieces(weight, pool.pieces_per_side()), statistics.n, pool,
                             share);
  };
  SPOOL_TRY(spend_in_rounds(spending, pool, options.rounds, "filtered_halves", context, choose));
  return end_spending(std::move(spending), pool);
}

Sampler filtered_halves_sampler() {
  using O = FilteredHalvesOptions;
  return make_value<SamplerFunction, O>(
      {.name = "filtered_halves",
       .summary = "where the filter in the loop disagrees on two halves of the samples",
       .options =
           {
               integer_option("rounds", &O::rounds, 1, 1000, "rounds that share the rest"),
               loop_filter_option(&O::filter),
           },
       .views = {{"error.i", "relative difference of the two filtered halves, round i"}},
       .needs = [](const auto& options) { return loop_needs(options.filter); },
       .memory = {128, 2e6},
       .cost = 9,
       .run = sample_filtered_halves});
}

}  // namespace spool
