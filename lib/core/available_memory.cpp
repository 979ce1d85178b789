#include "lib/core/available_memory.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

#include <sys/resource.h>
#include <unistd.h>

#include "lib/core/worker_threads.h"

namespace spool {
namespace {

namespace fs = std::filesystem;

void take_least(std::optional<std::uint64_t>& bytes, std::optional<std::uint64_t> other) {
  if (other) bytes = std::min(bytes.value_or(*other), *other);
}

// Empty for "max" and for what is not there.
std::optional<std::uint64_t> number_in(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

std::uint64_t entry_in(const fs::path& file, const std::string& wanted) {
  std::ifstream in(file);
  std::string name;
  for (std::uint64_t number = 0; in >> name >> number;) {
    if (name == wanted) return number;
  }
  return 0;
}

// The system takes pages of files back, those that were just used last.
struct GroupFiles {
  const char *limit, *usage, *inactive_cache, *active_cache;
};
constexpr GroupFiles kVersion1 = {"memory.limit_in_bytes", "memory.usage_in_bytes",
                                  "total_inactive_file", "total_active_file"};
constexpr GroupFiles kVersion2 = {"memory.max", "memory.current", "inactive_file", "active_file"};

std::optional<std::uint64_t> left_in(const fs::path& group, const GroupFiles& files) {
  const auto limit = number_in(group / files.limit), usage = number_in(group / files.usage);
  if (!limit || !usage) return {};
  const std::uint64_t cache = entry_in(group / "memory.stat", files.inactive_cache) +
                              entry_in(group / "memory.stat", files.active_cache);
  const std::uint64_t used = *usage - std::min(*usage, cache);
  return *limit - std::min(*limit, used);
}

// What each further thread takes of addresses: its stack, and a heap of its own.
constexpr std::uint64_t kBytesPerThread = (std::uint64_t{8} + 64) << 20;

// What a limit of the process leaves of pages of a kind; a field of /proc/self/statm counts those
// that are in use.
std::optional<std::uint64_t> left_of_limit(int resource, std::size_t field, std::uint64_t taken) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  for (std::size_t i = 0; i <= field; ++i)
    statm >> pages;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + taken;
  return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, used);
}

std::string_view asked_limit() {
  const char* limit = std::getenv("SPOOL_MEMORY");
  return limit == nullptr ? "" : limit;
}

std::optional<std::uint64_t> number_of_bytes(std::string_view text) {
  std::uint64_t bytes = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), bytes);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole ? std::optional(bytes) : std::nullopt;
}

}  // namespace

std::optional<std::uint64_t> memory_left_in_groups(const std::string& groups,
                                                   const fs::path& mounted) {
  std::optional<std::uint64_t> bytes;
  std::istringstream lines(groups);  // ID:CONTROLLERS:/PATH
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (!controllers.empty() && controllers != "memory") continue;
    const bool unified = controllers.empty();
    const fs::path top = unified ? mounted : mounted / "memory";
    // In a container the path may be that of the host; then only the top is there.
    for (fs::path path = fs::path(line.substr(second + 1)).relative_path();;
         path = path.parent_path()) {
      take_least(bytes, left_in(top / path, unified ? kVersion2 : kVersion1));
      if (path.empty()) break;
    }
  }
  return bytes;
}

std::optional<std::uint64_t> available_memory(std::uint64_t to_be_mapped) {
  std::optional<std::uint64_t> bytes;
  std::ifstream info("/proc/meminfo");  // absent on other systems than Linux
  for (std::string name, unit; info >> name;) {
    std::uint64_t kilobytes = 0;
    if (!(info >> kilobytes)) break;
    std::getline(info, unit);
    if (name == "MemAvailable:") bytes = 1024 * kilobytes;
  }
  std::ifstream own("/proc/self/cgroup");
  std::string groups;
  std::getline(own, groups, '\0');  // a read that fails ends it: the figure is a hint
  take_least(bytes, memory_left_in_groups(groups, "/sys/fs/cgroup"));
  const auto threads = static_cast<std::uint64_t>(allowed_threads() - 1);  // beside this one
  take_least(bytes, left_of_limit(RLIMIT_AS, 0, to_be_mapped + threads * kBytesPerThread));
  take_least(bytes, left_of_limit(RLIMIT_DATA, 5, threads * kBytesPerThread));
  take_least(bytes, number_of_bytes(asked_limit()));
  return bytes;
}

Result<void> check_memory_limit() {
  const std::string_view limit = asked_limit();
  if (limit.empty() || number_of_bytes(limit)) return {};
  return fail(
      ErrorCode::kUsage,
      "SPOOL_MEMORY: '{}' is no number of bytes, and would be no limit: write 4000000000, or "
      "leave it out",
      limit);
}

}  // namespace spool
