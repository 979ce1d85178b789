#include "tools/python/workers.h"

#include <pthread.h>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace spool::python {
namespace {

struct WaitedFor final : Job {
  std::promise<void> promise;
  std::future<void> ended = promise.get_future();

  bool wait_for(std::chrono::milliseconds time) override {
    return ended.wait_for(time) == std::future_status::ready;
  }
};

struct Task {
  std::function<void()> work;
  std::shared_ptr<WaitedFor> job;
};

struct Worker {
  std::mutex mutex;
  std::condition_variable woken;
  Task task;  // of which `job` is null where there is none
};

struct Idle {
  std::mutex mutex;
  std::vector<Worker*> workers;
};

// Never destroyed: its threads live until the process ends.
Idle& idle() {
  static Idle* const instance = [] {
    // The child of a fork has none of the threads.
    pthread_atfork([] { idle().mutex.lock(); }, [] { idle().mutex.unlock(); },
                   [] {
                     idle().workers.clear();
                     idle().mutex.unlock();
                   });
    return new Idle;
  }();
  return *instance;
}

void run_tasks(Worker& worker) {
  while (true) {
    Task task;
    {
      std::unique_lock lock(worker.mutex);
      worker.woken.wait(lock, [&] { return worker.task.job != nullptr; });
      task = std::exchange(worker.task, {});
    }
    task.work();
    task.work = nullptr;
    {
      const std::scoped_lock lock(idle().mutex);
      idle().workers.push_back(&worker);
    }
    task.job->promise.set_value();  // last: the next call is to find this thread
  }
}

Worker& waiting_worker() {
  {
    const std::scoped_lock lock(idle().mutex);
    if (!idle().workers.empty()) {
      Worker& worker = *idle().workers.back();
      idle().workers.pop_back();
      return worker;
    }
  }
  auto made = std::make_unique<Worker>();
  Worker& worker = *made;
  std::thread([&worker] { run_tasks(worker); }).detach();
  static_cast<void>(made.release());  // as long as its thread
  return worker;
}

}  // namespace

std::shared_ptr<Job> begin_job(std::function<void()> work) {
  const auto job = std::make_shared<WaitedFor>();
  Worker& worker = waiting_worker();
  {
    const std::scoped_lock lock(worker.mutex);
    worker.task = {std::move(work), job};
  }
  worker.woken.notify_one();
  return job;
}

}  // namespace spool::python
