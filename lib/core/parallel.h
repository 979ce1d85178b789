// Parallel loops with results that do not depend on the number of threads.
//
// Bodies must write disjoint memory and must not reduce across iterations: a sum that decides
// something goes through pairwise_sum.h.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include <oneapi/tbb/parallel_for.h>

namespace spool {

// Limits the threads of every parallel loop while it lives; 0 means all the machine has.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

// What a parallel loop throws when its work was stopped. No std::exception: what catches those on
// the way takes them for failures of one method.
struct WorkStopped {};

// Work that another thread may end in the middle of its parallel loops, however deep they are.
class StoppableWork {
 public:
  StoppableWork();
  ~StoppableWork();
  StoppableWork(const StoppableWork&) = delete;
  StoppableWork& operator=(const StoppableWork&) = delete;

  // From any thread. Throws WorkStopped where stop() was called in time, and what `work` throws.
  void run(const std::function<void()>& work);
  // From any thread, before run() or during it.
  void stop();

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

// body(i) for i = begin .. end-1, unless the work is stopped.
template <class Index, class Body>
void parallel_range(Index begin, Index end, Body&& body) {
  // A context of the loop's own: the only one that says whether it left something out.
  oneapi::tbb::task_group_context context;
  oneapi::tbb::parallel_for(
      begin, end,
      [&](Index i) {
        if (!context.is_group_execution_cancelled()) body(i);
      },
      context);
  if (context.is_group_execution_cancelled()) throw WorkStopped{};
}

template <class Body>
void parallel_for(std::size_t n, Body&& body) {
  if (n == 1) {
    body(std::size_t{0});
    return;
  }
  parallel_range(std::size_t{0}, n, body);
}

// body(y) for y = begin .. end-1.
template <class Body>
void parallel_rows(int begin, int end, Body&& body) {
  if (end > begin) parallel_range(begin, end, body);
}

}  // namespace spool
