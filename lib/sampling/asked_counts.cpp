#include "lib/sampling/asked_counts.h"

#include <algorithm>

#include "lib/sampling/apportion.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {

CountImage grant_wants(const CountImage& wanted, const CountImage& n, const SamplePool& pool,
                       long long left, GuardCounts& guards) {
  SPOOL_CHECK(wanted.same_size(n));
  std::vector<double> weight(n.size());
  std::vector<long long> room(n.size());  // of the pieces with a request
  long long wants = 0;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t i = n.index(x, y);
      SPOOL_CHECK_GE(wanted[i], 0);
      weight[i] = wanted[i];
      wants += wanted[i];
      room[i] = wanted[i] > 0 ? pool.capacity(x, y) - n(x, y) : 0;
      if (wanted[i] > room[i]) {
        guards.add(Guard::kWantBeyondPool, static_cast<std::uint64_t>(wanted[i] - room[i]));
      }
    }
  }
  CountImage granted(n.width(), n.height());
  if (wants <= left) {
    for (std::size_t i = 0; i < n.size(); ++i) {
      granted[i] = static_cast<std::int32_t>(std::min<long long>(wanted[i], room[i]));
      room[i] -= granted[i];
      wants -= granted[i];
    }
    left = wants;  // what was cut off
  }
  const std::vector<long long> more = apportion(weight, left, room);
  for (std::size_t i = 0; i < n.size(); ++i)
    granted[i] += static_cast<std::int32_t>(more[i]);
  return granted;
}

Result<SamplingResult> sample_asked_counts(const SamplePool& pool, long long budget,
                                           const AskedCountsOptions& options,
                                           const AskForCounts& ask,
                                           const SamplingContext& context) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const PieceStatistics& statistics = spending.statistics;
  for (int round = 0; round < options.rounds && spending.left > 0; ++round) {
    const int to_come = options.rounds - round;
    const long long share = (spending.left + to_come - 1) / to_come;
    SPOOL_ASSIGN(const CountImage wanted, ask({statistics, pool, round, options.rounds,
                                               spending.left, share, context.seed}));
    if (!wanted.same_size(statistics.n)) {
      return fail(ErrorCode::kData,
                  "{} x {} counts answered for {} x {} pieces: answer with an image of the size of "
                  "the statistics",
                  wanted.width(), wanted.height(), pool.width(), pool.height());
    }
    const CountImage granted =
        grant_wants(wanted, statistics.n, pool, spending.left, spending.log.guards);
    if (spend(spending, pool, granted) == 0) break;
    SPOOL_TRY(report_progress(context, "exec", budget - spending.left, budget));
  }
  return end_spending(std::move(spending), pool);
}

}  // namespace spool
