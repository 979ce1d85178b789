#include "lib/sampling/rounds.h"

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

CountImage hand_out(const Plane& weights, const CountImage& n, const SamplePool& pool,
                    long long share) {
  SPOOL_CHECK(weights.same_size(n));
  std::vector<long long> room(n.size());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      room[n.index(x, y)] = pool.capacity(x, y) - n(x, y);
  }
  const std::vector<long long> given = apportion(weights.pixels(), share, room);
  CountImage extra(n.width(), n.height());
  for (std::size_t i = 0; i < extra.size(); ++i)
    extra[i] = static_cast<std::int32_t>(given[i]);
  return extra;
}

void take_extra(PieceStatistics& statistics, const SamplePool& pool, const CountImage& extra) {
  SPOOL_CHECK(extra.same_size(statistics.n));
  parallel_rows(0, extra.height(), [&](int y) {
    for (int x = 0; x < extra.width(); ++x)
      take(statistics, pool, x, y, extra(x, y));
  });
}

Result<void> report_progress(const SamplingContext& context, std::string_view sampler,
                             long long spent, long long budget) {
  if (context.progress && budget > 0) {
    context.progress(static_cast<double>(spent) / static_cast<double>(budget));
  }
  if (context.cancelled != nullptr && (*context.cancelled)()) {
    return fail(ErrorCode::kData, "{}: cancelled", sampler);
  }
  return {};
}

void expose(PieceStatistics& statistics, const SamplePool& pool, double key, GuardCounts& guards) {
  AnalysisSignal signal;
  signal.exposure = exposure_of(statistics, key, guards);
  set_signal(statistics, pool, signal);
}

SamplingResult finished(SamplingLog log, PieceStatistics statistics, const SamplePool& pool) {
  log.spent = count_samples(statistics.n);
  finish_log(log, pool, statistics.n);
  // What a sampler kept for itself; a selection is what its counts say.
  statistics.channel_minimum.reset();
  statistics.channel_maximum.reset();
  SamplingResult result;
  result.log = std::move(log);
  result.selection.statistics = std::move(statistics);
  return result;
}

}  // namespace spool
