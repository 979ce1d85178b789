#include "formats/lost_pages.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <mutex>

namespace spool::format {

namespace {

// Only what is lock-free may be touched by a signal handler.
struct Range {
  std::atomic<bool> taken{false};
  std::atomic<uintptr_t> begin{0}, end{0};  // empty while it is being set up or forgotten
  std::atomic<bool> lost{false};
};
static_assert(std::atomic<uintptr_t>::is_always_lock_free);

std::array<Range, kMaxWatchedRanges> ranges;
struct sigaction former{};
std::uintptr_t page_bytes = 4096;

Range* range_of(uintptr_t address) {
  for (Range& range : ranges) {
    const uintptr_t begin = range.begin.load(std::memory_order_acquire);
    if (begin != 0 && address >= begin && address < range.end.load(std::memory_order_acquire))
      return &range;
  }
  return nullptr;
}

// Everything from the lost page on: the file is condemned, and one signal is enough.
bool put_zeros(Range& range, uintptr_t address) {
  const uintptr_t page = address / page_bytes * page_bytes;
  range.lost.store(true, std::memory_order_release);
  // An address is a number to the kernel.
  void* wanted = reinterpret_cast<void*>(page);  // NOLINT(performance-no-int-to-ptr)
  return ::mmap(wanted, range.end.load(std::memory_order_acquire) - page, PROT_READ,
                MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == wanted;
}

void on_bus_error(int signal, siginfo_t* info, void* context) {
  const int cause = errno;
  const auto address = reinterpret_cast<uintptr_t>(info->si_addr);
  Range* range = range_of(address);
  if (range == nullptr || !put_zeros(*range, address)) {
    if ((former.sa_flags & SA_SIGINFO) != 0 && former.sa_sigaction != nullptr) {
      former.sa_sigaction(signal, info, context);
    } else {
      ::signal(SIGBUS, SIG_DFL);  // the read is repeated, and ends the process as before
    }
  }
  errno = cause;
}

}  // namespace

void survive_lost_pages() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_bytes = static_cast<uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action{};
    action.sa_sigaction = on_bus_error;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(SIGBUS, &action, &former);
  });
}

int watch_range(const void* begin, size_t bytes) {
  for (int i = 0; i < kMaxWatchedRanges; ++i) {
    Range& range = ranges[static_cast<size_t>(i)];
    if (range.taken.exchange(true, std::memory_order_acq_rel)) continue;
    const auto at = reinterpret_cast<uintptr_t>(begin);
    range.lost.store(false, std::memory_order_relaxed);
    range.end.store(at + bytes, std::memory_order_release);
    range.begin.store(at, std::memory_order_release);
    return i;
  }
  return -1;
}

void forget_range(int range) {
  if (range < 0) return;
  Range& forgotten = ranges[static_cast<size_t>(range)];
  forgotten.begin.store(0, std::memory_order_release);
  forgotten.taken.store(false, std::memory_order_release);
}

bool lost_pages(int range) {
  return range >= 0 && ranges[static_cast<size_t>(range)].lost.load(std::memory_order_acquire);
}

}  // namespace spool::format
