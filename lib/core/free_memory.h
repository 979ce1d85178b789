// How much memory this process may still take, so that what will not fit is refused before work.
#pragma once

#include <cstdint>
#include <optional>

namespace spool {

// Bytes that the system would give (free, or held by caches it can drop), at most what the
// environment variable SPOOL_MEMORY says (bytes). Empty where neither is known.
std::optional<std::uint64_t> free_memory();

}  // namespace spool
