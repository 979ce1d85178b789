#include "lib/core/check.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

namespace spool {
namespace {

std::atomic<bool> g_throws = false;

}  // namespace

void throw_failed_checks() {
  g_throws = true;
}

void check_failed(const char* file, int line, const std::string& what) {
  if (g_throws) {
    const std::string_view path = file;
    throw std::logic_error(
        fmt::format("check failed: {} ({}:{}): an error of spool: report it with what was called",
                    what, path.substr(path.rfind('/') + 1), line));
  }
  fmt::print(stderr, "{}:{}: check failed: {}\n", file, line, what);
  std::abort();
}

}  // namespace spool
