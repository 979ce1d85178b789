#include "lib/experiment/peak_memory.h"

#include <fstream>
#include <string>

namespace spool {

void reset_peak_memory() {
  // "5" resets VmHWM: proc(5), /proc/pid/clear_refs.
  std::ofstream("/proc/self/clear_refs") << "5";
}

std::optional<std::uint64_t> peak_memory() {
  constexpr std::uint64_t kKibibyte = 1024;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * kKibibyte;
  }
  return std::nullopt;
}

}  // namespace spool
