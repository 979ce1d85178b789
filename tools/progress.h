// One line on a terminal that says how far a long task is and how long it will still take.
//
// Prints to stderr, only when that is a terminal and the program is not told to be quiet; otherwise
// it does nothing. Any thread may call update().
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
  bool visible_ = false;
  std::mutex mutex_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point printed_;
};

}  // namespace spool::tools
