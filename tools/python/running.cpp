#include "tools/python/running.h"

#include <nanobind/stl/string.h>

#include <chrono>
#include <exception>
#include <future>
#include <new>
#include <thread>

#include "lib/core/parallel.h"
#include "lib/core/visible_text.h"

namespace spool::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};

// Not a std::exception: what catches those on the way takes them for errors of one result.
struct Interrupted {};

Result<void> guarded(const std::function<Result<void>(Watch&)>& work, Watch& watch, int threads) {
  try {
    const ThreadLimit limit(threads);
    return work(watch);
  } catch (const Interrupted&) {
    return fail(ErrorCode::kData, "interrupted");
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kIo, "out of memory: use a smaller image");
  } catch (const std::exception& error) {
    return fail(ErrorCode::kData, "{}", error.what());
  }
}

}  // namespace

void Watch::update(double share) {
  share_ = share;
  if (stopped_) throw Interrupted{};
}

void Watch::update(double share, std::size_t done, std::size_t of) {
  done_ = done;
  of_ = of;
  update(share);
}

void raise(const Error& error) {
  const nb::object type = nb::module_::import_("spool.error").attr("SpoolError");
  const std::string line = visible_text(one_line(error.message));
  const nb::object exception = type.attr("of_code")(static_cast<int>(error.code), line);
  PyErr_SetObject(type.ptr(), exception.ptr());
  throw nb::python_error();
}

void run_watched(const std::function<Result<void>(Watch&)>& work, const nb::object& progress,
                 int threads) {
  Watch watch;
  std::promise<Result<void>> promise;
  std::future<Result<void>> result = promise.get_future();
  std::optional<nb::python_error> wanted;  // by a signal, or by `progress`
  std::optional<Result<void>> outcome;
  {
    const nb::gil_scoped_release released;
    const std::jthread worker([&] { promise.set_value(guarded(work, watch, threads)); });
    while (result.wait_for(kBetweenLooks) != std::future_status::ready) {
      if (wanted) continue;
      const nb::gil_scoped_acquire held;
      try {
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!progress.is_none()) progress(watch.share(), watch.done(), watch.of());
      } catch (nb::python_error& error) {
        wanted.emplace(error);
        watch.stop();
      }
    }
    outcome = result.get();
  }
  if (wanted) throw std::move(*wanted);
  if (!outcome->has_value()) raise(outcome->error());
  if (!progress.is_none()) progress(1.0, watch.of(), watch.of());
}

}  // namespace spool::python
