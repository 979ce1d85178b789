// Threads that stay: what a thread leaves behind in the libraries that it calls is not given back
// at its end (5 to 7 kB), so the next call finds the thread of the last one.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

namespace spool::python {

// Work on a thread of its own. The caller waits for its end.
class Job {
 public:
  virtual ~Job() = default;
  virtual bool wait_for(std::chrono::milliseconds time) = 0;  // true: it has ended
};

// On a thread that has nothing to do, or on a new one. `work` throws nothing.
std::shared_ptr<Job> begin_job(std::function<void()> work);

}  // namespace spool::python
