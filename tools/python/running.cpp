#include "tools/python/running.h"

#include <cxxabi.h>
#include <nanobind/stl/string.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>

#include <fmt/core.h>

#include "lib/core/visible_text.h"
#include "tools/verbs/option_bounds.h"

namespace spool::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};
constexpr std::chrono::seconds kLongestEnd{5};
constexpr std::size_t kLongestLine = 4096;  // bytes
constexpr std::size_t kMostCalls = 256;     // each has a thread

thread_local std::shared_ptr<Watch> t_watch;   // of the work that this thread does
thread_local std::vector<Watch*> t_callbacks;  // functions of one's own that run on it

// Calls that have not returned; with the interpreter's lock.
std::vector<Watch*>& calls() {
  static auto* const instance = new std::vector<Watch*>;
  return *instance;
}
unsigned long g_last_thread = 0;  // the one that ends the interpreter, from then on

Result<void> guarded(const std::function<Result<void>(Watch&)>& work, Watch& watch,
                     StoppableWork& stoppable, int threads) {
  try {
    const ThreadLimit limit(threads);
    Result<void> outcome;
    stoppable.run([&] { outcome = work(watch); });
    return outcome;
  } catch (const WorkStopped&) {
    return fail(ErrorCode::kData, "interrupted");
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kIo, "out of memory: use a smaller image");
  } catch (const std::exception& error) {
    return fail(ErrorCode::kData, "{}", error.what());
  }
}

}  // namespace

std::shared_ptr<Watch> Watch::current() {
  return t_watch;
}

void Watch::update(double share) {
  share_ = share;
  if (stopped_) throw WorkStopped{};
}

void Watch::update(double share, std::size_t done, std::size_t of) {
  done_ = done;
  of_ = of;
  update(share);
}

void Watch::stop() {
  stopped_ = true;
  work_.stop();
}

void Watch::enter_callback() {
  callbacks_.push_back(PyThread_get_thread_ident());
  t_callbacks.push_back(this);
}

void Watch::leave_callback() {
  std::erase(callbacks_, PyThread_get_thread_ident());
  t_callbacks.pop_back();
}

void Watch::interrupt_callbacks() {
  for (const unsigned long thread : callbacks_)
    PyThreadState_SetAsyncExc(thread, PyExc_KeyboardInterrupt);
}

void raise(const Error& error, const nb::object& cause) {
  const nb::object type = nb::module_::import_("spool.error").attr("SpoolError");
  const std::string line = visible_text(one_line(
      error.message.size() <= kLongestLine ? error.message
                                           : error.message.substr(0, kLongestLine) + " ..."));
  const nb::object exception = type.attr("of_code")(static_cast<int>(error.code), line);
  if (!cause.is_none()) exception.attr("__cause__") = cause;
  PyErr_SetObject(type.ptr(), exception.ptr());
  throw nb::python_error();
}

// The thread's end is no object: the reference that catches it is null, and UBSan says so.
__attribute__((no_sanitize("undefined"))) void survive_the_end(const std::function<void()>& work) {
  try {
    work();
  } catch (const abi::__forced_unwind&) {
    while (true)
      ::pause();
  }
}

bool wait_for(Job& job, std::chrono::milliseconds time) {
  bool ended = false;
  survive_the_end([&] {
    PyThreadState* const thread = PyEval_SaveThread();
    ended = job.wait_for(time);
    PyEval_RestoreThread(thread);
  });
  return ended;
}

// One call of a function of this module, from its begin to its end.
class WatchedCall {
 public:
  WatchedCall() {
    if (!t_callbacks.empty()) watch_->outer_ = t_callbacks.back()->shared_from_this();
    watch_->called_back_ = !t_callbacks.empty();
    calls().push_back(watch_.get());
  }
  ~WatchedCall() { std::erase(calls(), watch_.get()); }
  WatchedCall(const WatchedCall&) = delete;
  WatchedCall& operator=(const WatchedCall&) = delete;

  void run(const std::function<Result<void>(Watch&)>& work, const nb::object& progress,
           int threads) {
    Result<void> outcome;
    const auto job = begin_job([&] {
      t_watch = watch_;
      outcome = guarded(work, *watch_, watch_->work_, threads);
      t_watch.reset();
    });
    while (!wait_for(*job, kBetweenLooks))
      look(progress);
    if (wanted_) throw std::move(*wanted_);
    if (watch_->raised) throw std::move(*watch_->raised);
    if (!outcome) raise(outcome.error(), cause_of(outcome.error()));
    if (!progress.is_none()) progress(1.0, watch_->of(), watch_->of());
  }

 private:
  nb::object cause_of(const Error& error) const {
    for (const auto& [begin, raised] : watch_->failures) {
      if (error.message.find(begin) != std::string::npos) return nb::borrow(raised.value());
    }
    return nb::none();
  }

  // Each signal interrupts once more: a function may have caught the last one.
  void look(const nb::object& progress) {
    try {
      if (watch_->outer_ && watch_->outer_->stopped()) watch_->stop();
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!progress.is_none() && !wanted_) progress(watch_->share(), watch_->done(), watch_->of());
    } catch (nb::python_error& error) {
      if (!wanted_) wanted_.emplace(error);
      watch_->stop();
      watch_->interrupt_callbacks();
    }
  }

  std::shared_ptr<Watch> watch_ = std::make_shared<Watch>();
  std::optional<nb::python_error> wanted_;  // by a signal, or by `progress`
};

void end_all_work() {
  g_last_thread = PyThread_get_thread_ident();
  const auto begin = std::chrono::steady_clock::now();
  for (Watch* const watch : calls()) {
    watch->stop();
    watch->interrupt_callbacks();
  }
  while (!calls().empty() && std::chrono::steady_clock::now() - begin < kLongestEnd) {
    const nb::gil_scoped_release released;
    ::usleep(10'000);
  }
}

void forget_calls() {
  calls().clear();
}

void run_watched(const std::function<Result<void>(Watch&)>& work, const nb::object& progress,
                 int threads) {
  if (const auto bounds = tools::check_bounds("threads", threads, tools::kThreads); !bounds)
    raise(bounds.error());
  if (g_last_thread != 0 && g_last_thread != PyThread_get_thread_ident())
    raise({ErrorCode::kUsage, "the interpreter ends: no thread begins anything now"});
  // Functions of one's own that begin threads, and progress, can ask for themselves without an end.
  if (calls().size() >= kMostCalls)
    raise(
        {ErrorCode::kUsage, fmt::format("{} calls have not returned: begin fewer at once, and none "
                                        "from a function that it would call again",
                                        kMostCalls)});
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    raise({ErrorCode::kUsage, "progress: is no function: write one of (share, done, of)"});
  WatchedCall().run(work, progress, threads);
}

}  // namespace spool::python
