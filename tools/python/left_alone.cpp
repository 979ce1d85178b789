#include "tools/python/left_alone.h"

#include <chrono>
#include <optional>
#include <utility>

namespace spool::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};
constexpr std::chrono::milliseconds kGrace{500};  // for a function to end after Ctrl-C

// A function of one's own is at work in this thread.
class CallbackScope {
 public:
  explicit CallbackScope(Watch* watch) : watch_(watch) {
    if (watch_ != nullptr) watch_->enter_callback();
  }
  CallbackScope(const CallbackScope&) = delete;
  CallbackScope& operator=(const CallbackScope&) = delete;
  ~CallbackScope() {
    if (watch_ != nullptr) watch_->leave_callback();
  }

 private:
  Watch* watch_;
};

// One call, which may outlast the work that asked for it.
struct Call {
  nb::object function, told, answer;
  std::shared_ptr<Watch> watch;
  std::optional<nb::python_error> raised;
};

// False where the work was stopped and the function does not end.
bool ends(Job& job, const Watch* watch) {
  while (!wait_for(job, kBetweenLooks)) {
    if (watch != nullptr && watch->stopped()) return wait_for(job, kGrace);
  }
  return true;
}

}  // namespace

nb::object answer_to(nb::object told, const nb::object& function,
                     const std::shared_ptr<Watch>& watch) {
  const auto call =
      std::make_shared<Call>(Call{function, std::move(told), nb::none(), watch, std::nullopt});
  const auto job = begin_job([call = call]() mutable {
    survive_the_end([&] {
      const nb::gil_scoped_acquire lock;
      try {
        const CallbackScope callback(call->watch.get());
        const nb::object ask = call->function.attr("ask");
        PyObject* answer = nullptr;
        // It may outlast the interpreter: its thread then ends without what holds the lock.
        survive_the_end(
            [&] { answer = PyObject_CallFunctionObjArgs(ask.ptr(), call->told.ptr(), nullptr); });
        if (answer == nullptr) throw nb::python_error();
        call->answer = nb::steal(answer);
      } catch (nb::python_error& error) {
        call->raised.emplace(error);
      }
      call.reset();  // while the lock is held
    });
  });
  if (!ends(*job, watch.get())) throw WorkStopped{};
  if (call->raised) throw std::move(*call->raised);
  return call->answer;
}

}  // namespace spool::python
