// Guards that caught something, as JSON: {"name": count, ...}, in the order of lib/core/guards.h.
#pragma once

#include <nlohmann/json.hpp>

#include "lib/core/guards.h"

namespace spool::tools {

inline nlohmann::ordered_json guard_listing(const GuardCounts& counts) {
  nlohmann::ordered_json listing = nlohmann::ordered_json::object();
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    if (counts[guard] > 0) listing[std::string(guard_name(guard))] = counts[guard];
  }
  return listing;
}

}  // namespace spool::tools
