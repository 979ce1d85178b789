#include "lib/core/free_memory.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

namespace spool {

std::optional<std::uint64_t> free_memory() {
  std::optional<std::uint64_t> bytes;
  std::ifstream info("/proc/meminfo");  // absent on other systems than Linux
  for (std::string name, unit; info >> name;) {
    std::uint64_t kilobytes = 0;
    if (!(info >> kilobytes)) break;
    std::getline(info, unit);
    if (name == "MemAvailable:") bytes = 1024 * kilobytes;
  }
  if (const char* limit = std::getenv("SPOOL_MEMORY")) {
    char* end = nullptr;
    const unsigned long long wanted = std::strtoull(limit, &end, 10);
    if (end != limit && *end == '\0')
      bytes = std::min<std::uint64_t>(bytes.value_or(wanted), wanted);
  }
  return bytes;
}

}  // namespace spool
