// Long work away from the interpreter: without its lock, on a thread of its own, while the thread
// that asked for it looks for signals. Ctrl-C ends it in the middle of its parallel loops, and a
// function of one's own where it stands, or is left to itself (left_alone.h).
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/parallel.h"
#include "tools/python/workers.h"

namespace spool::python {

namespace nb = nanobind;

// What work reports and what it is asked; from any thread.
class Watch : public std::enable_shared_from_this<Watch> {
 public:
  // That of the work which this thread does, or null.
  static std::shared_ptr<Watch> current();

  // Throws WorkStopped, through the work, when its end was asked for.
  void update(double share);
  void update(double share, std::size_t done, std::size_t of);
  bool stopped() const { return stopped_; }
  void stop();

  double share() const { return share_; }
  std::size_t done() const { return done_; }
  std::size_t of() const { return of_; }
  // Whether a function of one's own asked for the work, or for work around it.
  bool is_called_back() const { return called_back_; }

  // The four below with the interpreter's lock. A function of one's own begins and ends on this
  // thread.
  void enter_callback();
  void leave_callback();
  // Raises KeyboardInterrupt in the functions that run now, where they stand.
  void interrupt_callbacks();
  // What a function raised that is no failure of its method (KeyboardInterrupt, SystemExit).
  std::optional<nb::python_error> raised;
  // What each method raised first, by its beginning of the line that became of it.
  std::map<std::string, nb::python_error> failures;

 private:
  friend class WatchedCall;

  StoppableWork work_;
  std::shared_ptr<Watch> outer_;  // of the work that a function belongs to which asked for this one
  bool called_back_ = false;
  std::vector<unsigned long> callbacks_;  // their threads, as Python counts them
  std::atomic<bool> stopped_ = false;
  std::atomic<double> share_ = 0.0;
  std::atomic<std::size_t> done_ = 0, of_ = 0;
};

// Raises spool.SpoolError with the line that the program would print; `cause` stands behind it.
[[noreturn]] void raise(const Error& error, const nb::object& cause = nb::none());

// A thread that wants the interpreter's lock after the interpreter's end is ended by Python (before
// 3.14), through frames of C++ that do not bear it: from here it waits for the end of the process.
// `work` takes the lock, or keeps it.
void survive_the_end(const std::function<void()>& work);

// Job::wait_for without the interpreter's lock, which this thread has.
bool wait_for(Job& job, std::chrono::milliseconds time);

// Ends all work and waits for it, some seconds at most; from the interpreter's `atexit`.
void end_all_work();

// In the child of a fork, which has none of the threads that made them.
void forget_calls();

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
