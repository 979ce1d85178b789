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

template <class Body>
void parallel_for(std::size_t n, Body&& body) {
  if (n == 1) {
    body(std::size_t{0});
    return;
  }
  oneapi::tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) { body(i); });
}

// body(y) for y = begin .. end-1.
template <class Body>
void parallel_rows(int begin, int end, Body&& body) {
  if (end <= begin) return;
  oneapi::tbb::parallel_for(begin, end, [&](int y) { body(y); });
}

}  // namespace spool
