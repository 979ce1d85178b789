#include "formats/interchange/expansion.h"

#include <algorithm>

#include "formats/checked_math.h"

namespace spool::interchange {

uint64_t Expansion::allowed(uint64_t source_bytes) const {
  return std::max(kFreeBytes, format::checked_multiply(times, source_bytes).value_or(UINT64_MAX));
}

Result<void> Expansion::check(const std::string& source, std::optional<uint64_t> bytes,
                              uint64_t source_bytes) const {
  if (bytes && *bytes <= allowed(source_bytes)) return {};
  const uint64_t wanted = bytes.value_or(UINT64_MAX);
  const uint64_t needed = format::divide_up(wanted, std::max<uint64_t>(source_bytes, 1));
  return fail(ErrorCode::kData,
              "{}: {} bytes would become {}, more than {} times as many: if that is right, give "
              "--max-expansion {}",
              source, source_bytes, wanted, times, needed);
}

}  // namespace spool::interchange
