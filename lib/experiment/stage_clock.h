// Wall and CPU time of a stage of the work.
#pragma once

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

// Whose CPU time counts: of everything that the process does, or where other work runs beside, of
// the thread that asks.
enum class CpuOf { kProcess, kThread };

// Runs from its construction.
class StageClock {
 public:
  explicit StageClock(CpuOf of = CpuOf::kProcess)
      : clock_(of == CpuOf::kThread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID) {}

  StageTime elapsed() const {
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
            cpu_seconds() - cpu_};
  }

 private:
  double cpu_seconds() const {
    timespec time{};
    clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  clockid_t clock_;
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_seconds();
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
