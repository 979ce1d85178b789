#include "tests/support/thread_count.h"

#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

namespace spool {
namespace {

// What the tests of this folder rest on: there really are several threads, even on one core.
TEST(ThreadCount, LoopsRunOnAsManyThreadsAsAskedFor) {
  for (const int threads : {1, 2, 3}) {
    std::set<std::thread::id> seen;
    std::mutex mutex;
    test::with_threads(threads, [&] {
      // A busy machine may take long to start the second thread: give it the time.
      const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
      parallel_for(100, [&](std::size_t) {
        for (;;) {
          {
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
            if (threads == 1 || seen.size() > 1) break;
          }
          if (std::chrono::steady_clock::now() > deadline) break;
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      });
      return 0;
    });
    EXPECT_LE(seen.size(), static_cast<std::size_t>(threads));
    EXPECT_EQ(seen.size() > 1, threads > 1);
  }
}

}  // namespace
}  // namespace spool
