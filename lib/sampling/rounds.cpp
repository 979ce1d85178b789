#include "lib/sampling/rounds.h"

#include <algorithm>
#include <functional>

#include "lib/core/parallel.h"
#include "lib/sampling/apportion.h"
#include "lib/sampling/uniform.h"

namespace spool {

int default_initial_samples(long long budget, const SamplePool& pool) {
  const long long pieces = static_cast<long long>(pool.width()) * pool.height();
  if (budget >= 8 * pieces) return 4;
  return pool.pieces_per_side() > 1 && budget < 4 * pieces ? 1 : 2;
}

CountImage initial_counts(const SamplePool& pool, long long budget, int each, std::uint64_t seed) {
  const CountImage none(pool.width(), pool.height());
  return raise_least_sampled(none, pool, none.bounds(), budget, seed, each);
}

std::vector<long long> equal_shares(long long total, int rounds) {
  SPOOL_CHECK_GE(total, 0);
  SPOOL_CHECK_GE(rounds, 1);
  std::vector<long long> shares(static_cast<std::size_t>(rounds), total / rounds);
  for (long long r = 0; r < total % rounds; ++r)
    ++shares[static_cast<std::size_t>(r)];
  return shares;
}

std::vector<long long> room_of(const CountImage& n, const SamplePool& pool) {
  std::vector<long long> room(n.size());
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x)
      room[n.index(x, y)] = pool.capacity(x, y) - n(x, y);
  });
  return room;
}

bool decide(const Plane& weights) {
  return std::ranges::any_of(weights.pixels(), [](double weight) { return weight > 0.0; });
}

CountImage hand_out(const Plane& weights, const CountImage& n, const SamplePool& pool,
                    long long share) {
  SPOOL_CHECK(weights.same_size(n));
  const std::vector<long long> given = apportion(weights.pixels(), share, room_of(n, pool));
  CountImage extra(n.width(), n.height());
  std::transform(given.begin(), given.end(), extra.pixels().begin(),
                 [](long long count) { return static_cast<std::int32_t>(count); });
  return extra;
}

Result<void> spend_in_rounds(Spending& spending, const SamplePool& pool, int rounds,
                             std::string_view sampler, const SamplingContext& context,
                             const std::function<Result<CountImage>(long long share)>& choose) {
  for (const long long share : equal_shares(spending.left, rounds)) {
    if (share == 0) continue;
    SPOOL_ASSIGN(CountImage extra, choose(share));
    if (extra.empty()) {
      const CountImage& n = spending.statistics.n;
      extra = raise_least_sampled(n, pool, n.bounds(), share, context.seed);
      std::ranges::transform(extra.pixels(), n.pixels(), extra.pixels().begin(), std::minus{});
      spending.log.uniform_remainder += share;
    }
    spend(spending, pool, extra);
    SPOOL_TRY(report_progress(context, sampler, count_samples(spending.statistics.n),
                              spending.log.budget));
  }
  return {};
}

}  // namespace spool
