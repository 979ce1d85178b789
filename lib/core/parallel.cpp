#include "lib/core/parallel.h"

#include <optional>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_group.h>

#include "lib/core/current_work.h"

namespace spool {

using oneapi::tbb::task_group_context;

struct ThreadLimit::Control {
  std::optional<oneapi::tbb::global_control> limit;
};

ThreadLimit::ThreadLimit(int threads) : control_(std::make_unique<Control>()) {
  if (threads > 0) {
    control_->limit.emplace(oneapi::tbb::global_control::max_allowed_parallelism,
                            static_cast<std::size_t>(threads));
  }
}

ThreadLimit::~ThreadLimit() = default;

namespace {

thread_local StoppableWork* t_work = nullptr;

}  // namespace

StoppableWork* current_work() {
  return t_work;
}

bool is_stopped() {
  return oneapi::tbb::is_current_task_group_canceling();
}

struct StoppableWork::Control {
  task_group_context context{task_group_context::isolated};
};

StoppableWork::StoppableWork() : control_(std::make_unique<Control>()) {}
StoppableWork::~StoppableWork() = default;

// As the one task of a group, by this thread: loops inside belong to the group.
void StoppableWork::run(const std::function<void()>& work) {
  StoppableWork* const outer = std::exchange(t_work, this);
  try {
    oneapi::tbb::parallel_for(0, 1, [&](int) { work(); }, control_->context);
  } catch (...) {
    t_work = outer;
    throw;
  }
  t_work = outer;
  if (control_->context.is_group_execution_cancelled()) throw WorkStopped{};
}

void StoppableWork::stop() {
  control_->context.cancel_group_execution();
}

bool LoopPart::stopped() const {
  return static_cast<task_group_context*>(group)->is_group_execution_cancelled();
}

void run_in_parts(std::int64_t begin, std::int64_t end, const void* body,
                  void (*run_part)(const void* body, const LoopPart& part)) {
  // A context of the loop's own: the only one that says whether it left something out.
  task_group_context context;
  oneapi::tbb::parallel_for(
      oneapi::tbb::blocked_range<std::int64_t>(begin, end),
      [&](const oneapi::tbb::blocked_range<std::int64_t>& part) {
        run_part(body, LoopPart{part.begin(), part.end(), &context});
      },
      context);
  if (context.is_group_execution_cancelled()) throw WorkStopped{};
}

}  // namespace spool
