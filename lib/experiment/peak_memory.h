// The largest resident memory of this process since it was last asked to forget.
#pragma once

#include <cstdint>
#include <optional>

namespace spool {

// Forgets the peak so far; without effect where the system does not allow it (the peak then is that
// of the whole process).
void reset_peak_memory();
// Bytes; nothing where the system does not say (no /proc).
std::optional<std::uint64_t> peak_memory();

}  // namespace spool
