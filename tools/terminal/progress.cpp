#include "tools/terminal/progress.h"

#include <unistd.h>
#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "lib/core/visible_text.h"
#include "tools/terminal/console.h"

namespace spool::tools {
namespace {

constexpr std::chrono::milliseconds kBetweenLines{100};
constexpr std::chrono::milliseconds kBetweenLogLines{60000};
// Before this the speed is not known well enough to promise a time.
constexpr std::chrono::milliseconds kBeforeEstimate{500};

}  // namespace

Progress::Progress(std::string task, bool quiet)
    : task_(std::move(task)),
      visible_(!quiet && !line_eraser().empty()),
      logged_(!quiet && !visible_) {}

Progress::~Progress() {
  if (visible_) print_raw_error(line_eraser());
}

void Progress::update(double share, const std::string& detail, std::optional<double> seconds_left) {
  if (!visible_ && !logged_) return;
  const std::scoped_lock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - printed_ < (visible_ ? kBetweenLines : kBetweenLogLines)) return;
  printed_ = now;
  const double done = std::clamp(share, 0.0, 1.0);
  std::string line = fmt::format("{} {:3.0f} %", task_, 100.0 * done);
  if (!seconds_left && now - start_ > kBeforeEstimate && done > 0.01) {
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    seconds_left = elapsed * (1.0 - done) / done;
  }
  if (seconds_left) line += ", " + format_seconds(*seconds_left) + " left";
  if (!detail.empty()) line += "  " + detail;
  if (logged_) {
    print_raw_error(visible_text(line) + "\n");
    return;
  }
  const std::size_t width = line_width(STDERR_FILENO);
  print_raw_error(
      fmt::format("{}{:.{}}", line_eraser(), visible_text(line), width > 0 ? width - 1 : 99));
}

}  // namespace spool::tools
