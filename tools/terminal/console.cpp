#include "tools/terminal/console.h"

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>

#include <fmt/core.h>

#include "lib/core/visible_text.h"

namespace spool::tools {

namespace {

constexpr std::size_t kLongestError = 360;  // bytes: with what goes before it at most 400
constexpr std::size_t kErrorEnd = 180;      // of these, of its end, which says what to do

constexpr std::size_t kMark = 32;  // what stands for the bytes that are left out

bool quiet = false;        // of notes
bool lost_output = false;  // of this process, to stdout

std::string shortened(const std::string& text) {
  if (text.size() <= kLongestError) return text;
  const std::size_t head = start_of_character(text, kLongestError - kErrorEnd - kMark);
  const std::size_t tail = start_of_character(text, text.size() - kErrorEnd);
  return fmt::format("{} [... {} bytes ...] {}", text.substr(0, head), tail - head,
                     text.substr(tail));
}

}  // namespace

void print(std::string_view text) {
  const std::string shown = visible_text(text, true);
  lost_output = std::fwrite(shown.data(), 1, shown.size(), stdout) < shown.size() || lost_output;
  lost_output = std::fflush(stdout) != 0 || lost_output;
}

void print_line(std::string_view text) {
  print(visible_text(text) + "\n");
}

Result<void> check_output() {
  if (!lost_output) return {};
  return fail(ErrorCode::kIo, "stdout: what was printed could not be written: check where it goes");
}

void print_raw_error(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

std::string_view line_eraser() {
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal && terminal == std::string_view("dumb");
  return ::isatty(STDERR_FILENO) == 1 && !dumb ? "\r\033[K" : "";
}

void print_error(const Error& error) {
  print_raw_error(fmt::format("spool: {}\n", shortened(visible_text(one_line(error.message)))));
}

void print_warning(std::string_view text) {
  print_raw_error(fmt::format("spool: warning: {}\n", shortened(visible_text(text))));
}

// Once for each text: a filter is made again for every cell of an evaluation.
void print_note(std::string_view text) {
  static std::mutex mutex;
  static std::set<std::string, std::less<>> printed;
  const std::lock_guard lock(mutex);
  if (quiet || text.empty() || !printed.emplace(text).second) return;
  print_raw_error(fmt::format("spool: note: {}\n", shortened(visible_text(text))));
}

void keep_quiet() {
  quiet = true;
}

void open_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    // The lowest free number is this one. A closed stdout stays one that cannot be written.
    static_cast<void>(::open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY));
  }
}

std::string format_bytes(double bytes) {
  static constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000.0 && unit < 4) {
    bytes /= 1000.0;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} B", bytes) : fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

std::string format_seconds(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} us", seconds * 1e6);
  if (seconds < 1.0) return fmt::format("{:.3g} ms", seconds * 1e3);
  if (seconds < 100.0) return fmt::format("{:.3g} s", seconds);
  const auto whole = std::llround(seconds);
  if (whole < 7200) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::vector<std::string> split_list(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    if (comma > 0) parts.emplace_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return parts;
}

}  // namespace spool::tools
