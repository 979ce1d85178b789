// A sampler from elsewhere: in each round it is asked how many more samples each piece shall get.
//
// Every piece takes its first samples; then, round after round, the answer is granted as far as
// budget and pool reach [y][x]:
//
//   sum of wants <= left   each piece gets what it wants, cut at its capacity; what is cut off goes
//                          to the other pieces of the answer, in proportion to their wants
//   sum of wants > left    `left` is apportioned in proportion to the wants
//
// Nothing goes to a piece that wants nothing. An answer of zeros ends the run; what is then left of
// the budget is reported, not spent.
#pragma once

#include <functional>
#include <optional>

#include "lib/sampling/sampler.h"

namespace spool {

struct CountQuestion {
  const PieceStatistics& statistics;  // of everything taken so far
  const SamplePool& pool;
  int round = 0, rounds = 1;  // 0 .. rounds - 1
  long long left = 0;         // of the budget
  long long share = 0;        // of `left`, were it spent evenly over the rounds to come
  std::uint64_t seed = 0;
};

// How many more samples of each piece, not negative.
using AskForCounts = std::function<Result<CountImage>(const CountQuestion&)>;

struct AskedCountsOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples()
  int rounds = 4;
};

// Errors: those of `ask`; kData when its answer has another size than the grid of pieces.
Result<SamplingResult> sample_asked_counts(const SamplePool& pool, long long budget,
                                           const AskedCountsOptions& options,
                                           const AskForCounts& ask, const SamplingContext& context);

// What of `wanted` is taken; see above. Counts in `guards` what was beyond the pool.
CountImage grant_wants(const CountImage& wanted, const CountImage& n, const SamplePool& pool,
                       long long left, GuardCounts& guards);

}  // namespace spool
