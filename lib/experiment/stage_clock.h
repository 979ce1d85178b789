// Wall and CPU time of a stage of the work.
#pragma once

#include <chrono>
#include <ctime>
#include <utility>
#include <vector>

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

// Medians of each; the spread of the wall times. `times` is not empty.
StageTime median_time(std::vector<StageTime> times);
StageTime mean_time(const std::vector<StageTime>& times);

// `work` once more for each repeat; the last outcome and the times of all.
template <class Work>
auto timed(int repeats, StageTime& time, Work&& work) {
  std::vector<StageTime> times;
  while (true) {
    const StageClock clock;
    auto outcome = work();
    times.push_back(clock.elapsed());
    if (!outcome || static_cast<int>(times.size()) >= repeats) {
      time = median_time(std::move(times));
      return outcome;
    }
  }
}

}  // namespace spool
