// File calls that fail, shorten or interrupt on demand, put in place of the system's.
#pragma once

#include <cerrno>
#include <cstdint>

#include "formats/file_handle.h"
#include "tests/formats/made_dump.h"

namespace spool::format {

enum class Call { kOpen, kClose, kSize, kRead, kWrite, kSync, kTruncate, kLock, kRename, kMap };
inline constexpr int kCallKinds = 10;

struct FaultPlan {
  Call call = Call::kWrite;
  uint64_t fail_at = 0;   // the k-th call of this kind from 1 fails; 0: none
  bool for_ever = false;  // and all after it
  int error = EIO;

  bool random = false;  // short transfers and EINTR in random places
  uint64_t seed = 0;
  uint64_t disk_bytes = UINT64_MAX;  // no file grows beyond: ENOSPC
};

// One plan at a time; the system's calls are back when it goes.
class FaultyCalls {
 public:
  explicit FaultyCalls(const FaultPlan& plan) {
    state() = State{plan, {}, 0};
    static const FileCalls calls = make();
    replace_file_calls(calls);
  }
  FaultyCalls(const FaultyCalls&) = delete;
  FaultyCalls& operator=(const FaultyCalls&) = delete;
  ~FaultyCalls() { replace_file_calls(posix_calls()); }

  // Whether the planned call came at all.
  bool struck() const {
    return state().counts[static_cast<size_t>(state().plan.call)] >= state().plan.fail_at;
  }

 private:
  struct State {
    FaultPlan plan;
    std::array<uint64_t, kCallKinds> counts{};
    uint64_t draws = 0;
  };
  static State& state() {
    static State current;
    return current;
  }

  static bool fails(Call call) {
    State& now = state();
    const uint64_t count = ++now.counts[static_cast<size_t>(call)];
    const FaultPlan& plan = now.plan;
    if (plan.call != call || plan.fail_at == 0) return false;
    if (count != plan.fail_at && !(plan.for_ever && count > plan.fail_at)) return false;
    errno = plan.error;
    return true;
  }
  static uint64_t draw() { return mix(state().plan.seed ^ mix(++state().draws)); }
  static bool interrupted() {
    if (!state().plan.random || draw() % 2 == 0) return false;
    errno = EINTR;
    return true;
  }
  static size_t shortened(size_t bytes) {
    if (!state().plan.random || bytes < 2) return bytes;
    const uint64_t kind = draw() % 3;
    if (kind == 0) return 1;
    return kind == 1 ? 1 + draw() % bytes : bytes;
  }

  static FileCalls make() {
    FileCalls calls = posix_calls();
    calls.open = [](const char* path, int flags, mode_t mode) {
      if (fails(Call::kOpen) || interrupted()) return -1;
      return posix_calls().open(path, flags, mode);
    };
    calls.close = [](int fd) {
      posix_calls().close(fd);  // a failed close has closed all the same
      return fails(Call::kClose) ? -1 : 0;
    };
    calls.file_size = [](int fd, uint64_t* bytes, bool* regular) {
      return fails(Call::kSize) ? -1 : posix_calls().file_size(fd, bytes, regular);
    };
    calls.pread = [](int fd, void* data, size_t bytes, off_t offset) -> ssize_t {
      if (fails(Call::kRead) || interrupted()) return -1;
      return posix_calls().pread(fd, data, shortened(bytes), offset);
    };
    calls.pwrite = [](int fd, const void* data, size_t bytes, off_t offset) -> ssize_t {
      if (fails(Call::kWrite) || interrupted()) return -1;
      const uint64_t limit = state().plan.disk_bytes;
      const auto at = static_cast<uint64_t>(offset);
      if (at >= limit) {
        errno = ENOSPC;
        return -1;
      }
      return posix_calls().pwrite(fd, data, std::min<uint64_t>(shortened(bytes), limit - at),
                                  offset);
    };
    calls.fsync = [](int fd) { return fails(Call::kSync) ? -1 : posix_calls().fsync(fd); };
    calls.ftruncate = [](int fd, off_t bytes) {
      return fails(Call::kTruncate) || interrupted() ? -1 : posix_calls().ftruncate(fd, bytes);
    };
    calls.lock = [](int fd) {
      return fails(Call::kLock) || interrupted() ? -1 : posix_calls().lock(fd);
    };
    calls.rename = [](const char* from, const char* to, bool replace) {
      return fails(Call::kRename) ? -1 : posix_calls().rename(from, to, replace);
    };
    calls.map = [](int fd, size_t bytes) -> void* {
      return fails(Call::kMap) ? nullptr : posix_calls().map(fd, bytes);
    };
    return calls;
  }
};

}  // namespace spool::format
