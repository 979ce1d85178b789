// Parallel loops with results that do not depend on the number of threads.
//
// Bodies must write disjoint memory and must not reduce across iterations: a sum that decides
// something goes through pairwise_sum.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "lib/core/rectangle.h"

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

// A part of a parallel loop's indices. The loops' library stays in parallel.cpp: its headers would
// be the larger half of many objects.
struct LoopPart {
  std::int64_t begin;
  std::int64_t end;
  void* group;  // what a stop reaches

  bool stopped() const;
};

void run_in_parts(std::int64_t begin, std::int64_t end, const void* body,
                  void (*run_part)(const void* body, const LoopPart& part));

// body(i) for i = begin .. end-1, unless the work is stopped.
template <class Index, class Body>
void parallel_range(Index begin, Index end, const Body& body) {
  run_in_parts(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end), &body,
               [](const void* erased, const LoopPart& part) {
                 const Body& each = *static_cast<const Body*>(erased);
                 for (std::int64_t i = part.begin; i < part.end; ++i) {
                   if (!part.stopped()) each(static_cast<Index>(i));
                 }
               });
}

template <class Body>
void parallel_for(std::size_t n, const Body& body) {
  if (n == 1) {
    body(std::size_t{0});
    return;
  }
  parallel_range(std::size_t{0}, n, body);
}

// body(tile) for tiles of `width` x `height` that cover `bounds`; at its right and lower edge they
// are smaller.
template <class Body>
void parallel_tiles(const Rectangle& bounds, int width, int height, const Body& body) {
  const int across = (bounds.width() + width - 1) / width;
  const int down = (bounds.height() + height - 1) / height;
  parallel_for(static_cast<std::size_t>(across) * static_cast<std::size_t>(down),
               [&](std::size_t i) {
                 const int x = bounds.x0 + static_cast<int>(i) % across * width;
                 const int y = bounds.y0 + static_cast<int>(i) / across * height;
                 body(intersect({x, y, x + width, y + height}, bounds));
               });
}

// body(y) for y = begin .. end-1.
template <class Body>
void parallel_rows(int begin, int end, const Body& body) {
  if (end > begin) parallel_range(begin, end, body);
}

}  // namespace spool
