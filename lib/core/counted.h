// Counts in sentences.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/core.h>

namespace spool {

// "1 block", "3 blocks"; "1 block was", "3 blocks were" of ("block was", "blocks were").
inline std::string counted(std::uint64_t number, std::string_view one,
                           std::string_view several = {}) {
  if (number == 1 || !several.empty())
    return fmt::format("{} {}", number, number == 1 ? one : several);
  return fmt::format("{} {}s", number, one);
}

}  // namespace spool
