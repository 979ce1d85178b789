#include "lib/sampling/given_counts.h"

#include <utility>

#include "lib/sampling/spending.h"

namespace spool {

Result<SamplingResult> sample_given_counts(const SamplePool& pool, long long budget,
                                           const CountImage& counts, const std::string& name,
                                           const SamplingContext& context) {
  if (counts.width() != pool.width() || counts.height() != pool.height()) {
    return fail(ErrorCode::kData,
                "{}: is {} x {} counts, the recording {} x {} pieces: make it as large", name,
                counts.width(), counts.height(), pool.width(), pool.height());
  }
  for (int y = 0; y < counts.height(); ++y) {
    for (int x = 0; x < counts.width(); ++x) {
      if (counts(x, y) >= 0 && counts(x, y) <= pool.capacity(x, y)) continue;
      return fail(ErrorCode::kData,
                  "{}: count {} of piece {},{} is outside 0 .. {}: clamp the counts to what was "
                  "recorded and is not held out",
                  name, counts(x, y), x, y, pool.capacity(x, y));
    }
  }
  Spending spending = begin_spending(pool, budget, counts);
  spending.log.initial = 0;  // every sample follows a decision, made elsewhere
  SPOOL_TRY(report_progress(context, "counts", 1, 1));
  return end_spending(std::move(spending), pool);
}

}  // namespace spool
