// Wall and CPU time of a stage of the work.
#pragma once

#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <utility>
#include <vector>

namespace spool {

struct StageTime {
  double wall = 0.0;    // seconds; the median of the repeats
  double cpu = 0.0;     // seconds of all threads (CpuOf); the median of the repeats
  double spread = 0.0;  // slowest less fastest repeat, wall seconds; 0 with one
};

// Whose CPU time counts: of everything that the process does, commands that it ran and waited for
// too, or where other work runs beside, of the thread that asks.
enum class CpuOf { kProcess, kThread };

// Runs from its construction.
class StageClock {
 public:
  explicit StageClock(CpuOf of = CpuOf::kProcess) : of_(of), cpu_(cpu_seconds()) {}

  StageTime elapsed() const {
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
            cpu_seconds() - cpu_};
  }

 private:
  double cpu_seconds() const {
    const bool thread = of_ == CpuOf::kThread;
    timespec time{};
    clock_gettime(thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &time);
    const double own = static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    return thread ? own : own + children();
  }

  static double children() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
  }

  CpuOf of_;
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_;
};

// Medians of each; the spread of the wall times. `times` is not empty.
StageTime median_time(std::vector<StageTime> times);
StageTime mean_time(const std::vector<StageTime>& times);

// `work` once more for each repeat; the last outcome and the times of all.
template <class Work>
auto timed(int repeats, CpuOf of, StageTime& time, Work&& work) {
  std::vector<StageTime> times;
  while (true) {
    const StageClock clock(of);
    auto outcome = work();
    times.push_back(clock.elapsed());
    if (!outcome || static_cast<int>(times.size()) >= repeats) {
      time = median_time(std::move(times));
      return outcome;
    }
  }
}

}  // namespace spool
