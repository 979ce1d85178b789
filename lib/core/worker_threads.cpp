#include "lib/core/worker_threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include "lib/core/current_work.h"
#include "lib/core/parallel.h"

namespace spool {

int allowed_threads() {
  return static_cast<int>(oneapi::tbb::global_control::active_value(
      oneapi::tbb::global_control::max_allowed_parallelism));
}

void for_each_on_threads(std::size_t n, int threads, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr thrown;
  std::mutex mutex;
  StoppableWork* const part_of = current_work();  // stops the loops of the bodies
  const auto work = [&] {
    oneapi::tbb::task_arena alone(1);
    alone.execute([&] {
      for (std::size_t i = next++; i < n; i = next++) {
        try {
          if (part_of) {
            part_of->run([&] { body(i); });
          } else {
            body(i);
          }
        } catch (...) {
          const std::lock_guard lock(mutex);
          if (!thrown) thrown = std::current_exception();
          next = n;
        }
      }
    });
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t t = 0; t < std::min<std::size_t>(n, static_cast<std::size_t>(threads)); ++t)
      workers.emplace_back(work);
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace spool
