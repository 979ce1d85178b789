#include "lib/sampling/cross_halves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

// One half of the samples: what it took, and what it may take.
struct Half {
  SamplePool pool;
  Spending spending;
};

std::array<SamplePool, 2> halves_of(const SamplePool& pool) {
  return {pool.half(0), pool.half(1)};
}

// What each half may spend: half of the budget, and what the other one has not.
std::array<long long, 2> split_budget(const std::array<SamplePool, 2>& pools, long long budget) {
  const long long even = pools[0].total_capacity(), odd = pools[1].total_capacity();
  const long long to_odd = std::min(std::max(budget / 2, budget - even), odd);
  return {std::min(budget - to_odd, even), to_odd};
}

// Two samples of each piece decide. Where that leaves each half less than one for the other's
// decision, the even half decides with its whole share, and the odd one begins with one.
std::array<long long, 2> least_first(const std::array<long long, 2>& budgets, long long pieces) {
  if (budgets[0] >= 2 * pieces && budgets[1] < 3 * pieces) return {budgets[0], pieces};
  return {2 * pieces, 2 * pieces};
}

std::array<Half, 2> begin_halves(const SamplePool& pool, long long budget, double start,
                                 std::uint64_t seed) {
  const long long pieces = static_cast<long long>(pool.width()) * pool.height();
  const std::array<SamplePool, 2> pools = halves_of(pool);
  const std::array<long long, 2> budgets = split_budget(pools, budget);
  const std::array<long long, 2> least = least_first(budgets, pieces);
  const auto begin = [&](std::size_t h) -> Half {
    const long long share = budgets[h];
    const auto uniform = std::llround(start * static_cast<double>(share));
    const CountImage each = initial_counts(pools[h], std::min(share, std::max(uniform, least[h])),
                                           std::numeric_limits<int>::max(), mix(seed, h));
    return {pools[h], begin_spending(pools[h], share, each)};
  };
  return {begin(0), begin(1)};
}

SamplingResult end_halves(std::array<Half, 2> halves, const SamplePool& pool, long long budget) {
  SamplingResult result;
  std::vector<Selection> selections;
  for (Half& half : halves) {
    result.log.initial += half.spending.log.initial;
    result.log.guards += half.spending.log.guards;
    selections.push_back({std::move(half.spending.statistics), {}});
  }
  // The exposure of each was of its first samples.
  set_signal(selections[1].statistics, halves[1].pool, selections[0].statistics.signal);
  result.selection = join_halves(pool, std::move(selections));
  result.log.budget = budget;
  finish_log(result.log, pool, result.selection.statistics.n);
  return result;
}

}  // namespace

Result<SamplingResult> sample_cross_halves(const SamplePool& pool, long long budget,
                                           const CrossHalvesOptions& options,
                                           const SamplingContext& context) {
  SPOOL_TRY(check_loop(context, "cross_halves"));
  std::array<Half, 2> halves = begin_halves(pool, budget, options.start, context.seed);
  // Where one half decides alone, more rounds would decide the same.
  const int rounds = halves[0].spending.left == 0 ? 1 : options.rounds;
  const std::array<std::vector<long long>, 2> shares = {
      equal_shares(halves[0].spending.left, rounds), equal_shares(halves[1].spending.left, rounds)};
  for (std::size_t round = 0; round < shares[0].size(); ++round) {
    if (shares[0][round] == 0 && shares[1][round] == 0) continue;
    std::array<Plane, 2> weight;
    for (std::size_t h = 0; h < 2; ++h) {
      if (shares[1 - h][round] == 0) continue;
      Plane error;
      SPOOL_ASSIGN(weight[h], filter_disagreement(halves[h].spending.statistics, halves[h].pool,
                                                  context.filter, options.blur, &error));
      if (context.views != nullptr) context.views->add_next("error", error);
    }
    for (std::size_t h = 0; h < 2; ++h) {
      if (shares[h][round] == 0) continue;
      Half& placed = halves[h];
      spend(placed.spending, placed.pool,
            hand_out_deficits(pixels_to_pieces(weight[1 - h], pool.pieces_per_side()),
                              placed.spending.statistics.n, placed.pool, shares[h][round]));
    }
    SPOOL_TRY(report_progress(context, "cross_halves",
                              budget - halves[0].spending.left - halves[1].spending.left, budget));
  }
  return end_halves(std::move(halves), pool, budget);
}

Sampler cross_halves_sampler() {
  using O = CrossHalvesOptions;
  return make_value<SamplerFunction, O>(
      {.name = "cross_halves",
       .summary = "two halves of the samples: where the filter in the loop disagrees on one of "
                  "them, the other one samples",
       .options =
           {
               number_option("start", &O::start, 0.0, 1.0, "share of the budget that is uniform"),
               integer_option("rounds", &O::rounds, 1, 1000, "rounds that share the rest"),
               loop_filter_option(&O::filter),
           },
       .views = {{"error.i",
                  "relative difference of the filtered halves of half i % 2, round i / 2"}},
       .needs = [](const auto& options) { return loop_needs(options.filter); },
       .memory = {201, 2e6},
       .cost = 3.7,
       .run = sample_cross_halves});
}

}  // namespace spool
