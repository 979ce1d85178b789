// One line on a terminal that says how far a long task is and how long it will still take.
//
// Prints to stderr, unless the program shall be quiet: one line that is overwritten where that
// is a terminal, else a line a minute, the first after a minute, for log files. Any thread may call
// update().
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>

namespace spool::tools {

class Progress {
 public:
  Progress(std::string task, bool quiet);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Share of the work done, 0 .. 1. Without `seconds_left` the time left follows from the share.
  void update(double share, const std::string& detail = {},
              std::optional<double> seconds_left = std::nullopt);

 private:
  using Clock = std::chrono::steady_clock;

  std::string task_;
  bool visible_ = false;  // on a terminal
  bool logged_ = false;   // elsewhere
  std::mutex mutex_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point printed_ = logged_ ? start_ : Clock::time_point{};
};

}  // namespace spool::tools
