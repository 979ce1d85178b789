// Tests with large numbers run a part of them, and all under `tools/dev.sh trust`
// (SPOOL_TRUST=whole).
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace spool::test {

inline bool whole_trust_run() {
  const char* value = std::getenv("SPOOL_TRUST");
  return value != nullptr && std::string_view(value) == "whole";
}

inline uint64_t trust_count(uint64_t part, uint64_t whole) {
  return whole_trust_run() ? whole : part;
}

}  // namespace spool::test
