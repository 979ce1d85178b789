// One line on a terminal that says how far a long task is and how long it will still take.
//
// Prints to stderr, only when that is a terminal and the program is not told to be quiet; otherwise
// it does nothing. Any thread may call update().
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace spool::tools {

class Progress {
 public:
  Progress(std::string task, bool quiet);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(double share, const std::string& detail = {});  // share of the work done, 0 .. 1

 private:
  using Clock = std::chrono::steady_clock;

  std::string task_;
  bool visible_ = false;
  std::mutex mutex_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point printed_;
};

}  // namespace spool::tools
