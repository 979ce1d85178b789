// How much memory this process may still take, so that what will not fit is refused before work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/error.h"

namespace spool {

// Bytes that the system would give (free, or held by caches it can drop), at most what the control
// groups of the process leave (containers), at most what its own limits leave (ulimit -v and -d),
// and at most what the environment variable SPOOL_MEMORY says (bytes). Empty where none of them is
// known. Files that are going to be mapped, of so many bytes together, count against ulimit -v
// only.
std::optional<std::uint64_t> available_memory(std::uint64_t to_be_mapped = 0);

// kUsage where SPOOL_MEMORY is no number of bytes: "4GB" would be no limit.
Result<void> check_memory_limit();

// What the control groups leave, from the text of /proc/self/cgroup and the folder where groups are
// mounted: the least over the groups and their parents of limit - (usage - file cache).
std::optional<std::uint64_t> memory_left_in_groups(const std::string& groups,
                                                   const std::filesystem::path& mounted);

}  // namespace spool
