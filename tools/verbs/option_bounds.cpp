#include "tools/verbs/option_bounds.h"

#include <limits>

#include "lib/core/option_table.h"

namespace spool::tools {

Result<void> check_bounds(std::string_view name, double value, const Bounds& bounds) {
  if (value >= bounds.lowest && value <= bounds.highest) return {};
  return fail(ErrorCode::kUsage, "{}: {} is outside {}", name, value,
              number_range(bounds.lowest, bounds.highest));
}

Result<void> check_seed(std::uint64_t seed) {
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  if (seed <= static_cast<std::uint64_t>(kMost)) return {};
  return fail(ErrorCode::kUsage, "seed: {} is outside 0 .. {}", static_cast<std::int64_t>(seed),
              kMost);
}

Result<void> validate(const PoolOptions& pool) {
  SPOOL_TRY(check_seed(pool.seed));
  SPOOL_TRY(check_bounds("holdout", pool.holdout, kHoldout));
  return check_bounds("pieces", pool.pieces_per_side, kPiecesPerSide);
}

}  // namespace spool::tools
