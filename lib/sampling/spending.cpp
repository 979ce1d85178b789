#include "lib/sampling/spending.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/core/parallel_count.h"

namespace spool {

Spending begin_spending(const SamplePool& pool, long long budget, const CountImage& first,
                        ChannelRange range) {
  SPOOL_CHECK_GE(budget, 0);
  Spending spending;
  spending.statistics = prefix_statistics(pool, first, {}, range == ChannelRange::kKept);
  spending.log.budget = budget;
  spending.log.initial = count_samples(first);
  spending.left = std::max(0LL, std::min(budget, pool.total_capacity()) - spending.log.initial);
  expose(spending.statistics, pool, spending.log.guards);
  return spending;
}

void expose(PieceStatistics& statistics, const SamplePool& pool, GuardCounts& guards) {
  AnalysisSignal signal;
  signal.exposure = exposure_of(statistics, guards);
  set_signal(statistics, pool, signal);
}

long long spend(Spending& spending, const SamplePool& pool, const CountImage& extra) {
  PieceStatistics& statistics = spending.statistics;
  SPOOL_CHECK(extra.same_size(statistics.n));
  take_each(statistics, pool, extra);
  const long long taken = count_samples(extra);
  spending.left -= taken;
  return taken;
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

SamplingResult end_spending(Spending spending, const SamplePool& pool) {
  PieceStatistics& statistics = spending.statistics;
  finish_log(spending.log, pool, statistics.n);
  // What a sampler kept for itself; a selection is what its counts say.
  statistics.channel_minimum.reset();
  statistics.channel_maximum.reset();
  SamplingResult result;
  result.log = std::move(spending.log);
  result.selection.statistics = std::move(statistics);
  return result;
}

long long sample_budget(double samples_per_pixel, const RecordedSamples& recording) {
  SPOOL_CHECK_GE(samples_per_pixel, 0.0);
  constexpr double kBeyondAnyPool = 0x1p62;  // and still a whole number
  return std::llround(
      std::min(samples_per_pixel * recording.width() * recording.height(), kBeyondAnyPool));
}

long long count_samples(const CountImage& n) {
  return parallel_count<long long>(n.size(), [&](std::size_t i) { return n[i]; });
}

long long count_saturated(const SamplePool& pool, const CountImage& n) {
  return parallel_count_rows<long long>(n.height(), [&](int y) {
    long long saturated = 0;
    for (int x = 0; x < n.width(); ++x)
      saturated += n(x, y) >= pool.capacity(x, y);
    return saturated;
  });
}

void finish_log(SamplingLog& log, const SamplePool& pool, const CountImage& n) {
  log.spent = count_samples(n);
  log.saturated_pieces = count_saturated(pool, n);
  log.guards.add(Guard::kSaturatedPieces, static_cast<std::uint64_t>(log.saturated_pieces));
  log.guards.add(Guard::kUniformRemainder, static_cast<std::uint64_t>(log.uniform_remainder));
}

}  // namespace spool
