// Wall and CPU time of a stage of the work.
#pragma once

#include <chrono>
#include <ctime>

namespace spool {

struct StageTime {
  double wall = 0.0;    // seconds; the median of the repeats
  double cpu = 0.0;     // seconds of all threads of the process; the median of the repeats
  double spread = 0.0;  // slowest less fastest repeat, wall seconds; 0 with one
};

// Runs from its construction.
class StageClock {
 public:
  StageTime elapsed() const {
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
            cpu_seconds() - cpu_};
  }

 private:
  static double cpu_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_seconds();
};

}  // namespace spool
