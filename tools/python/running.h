// Long work away from the interpreter: without its lock, on a thread of its own, while the thread
// that asked for it looks for signals. Ctrl-C ends it where it next says how far it is.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include "lib/core/error.h"

namespace spool::python {

namespace nb = nanobind;

// What work says of itself, and is told; from any thread.
class Watch {
 public:
  // Throws, through the work, when somebody asked for its end.
  void update(double share);
  void update(double share, std::size_t done, std::size_t of);
  bool stopped() const { return stopped_; }
  void stop() { stopped_ = true; }

  double share() const { return share_; }
  std::size_t done() const { return done_; }
  std::size_t of() const { return of_; }

 private:
  std::atomic<bool> stopped_ = false;
  std::atomic<double> share_ = 0.0;
  std::atomic<std::size_t> done_ = 0, of_ = 0;
};

// Raises spool.SpoolError with the line that the program would print.
[[noreturn]] void raise(const Error& error);

// Runs `work` with at most `threads` threads (0: all). `progress`: None, or called with the share
// done, results done and results in all, a few times a second. Raises what Python wants raised
// meanwhile (KeyboardInterrupt), else the error of the work.
void run_watched(const std::function<Result<void>(Watch&)>& work, const nb::object& progress,
                 int threads);

template <class T>
T run(const std::function<Result<T>(Watch&)>& work, const nb::object& progress, int threads) {
  std::optional<T> result;
  run_watched(
      [&](Watch& watch) -> Result<void> {
        SPOOL_ASSIGN(result, work(watch));
        return {};
      },
      progress, threads);
  return std::move(*result);
}

}  // namespace spool::python
