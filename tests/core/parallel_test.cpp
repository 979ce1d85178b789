#include "lib/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "lib/core/check.h"
#include "lib/core/parallel_sort.h"
#include "lib/core/total_order.h"

namespace spool {
namespace {

TEST(StoppableWork, LeavesItsLoopsHoweverDeepTheyAre) {
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    StoppableWork work;
    std::atomic<long long> done = 0;
    std::atomic<bool> went_on = false;
    const auto endless = [&] {
      parallel_rows(0, 64, [&](int) {
        parallel_for(100, [&](std::size_t) {
          parallel_rows(0, 1'000'000'000, [&](int) { ++done; });
          went_on = true;
        });
      });
    };
    std::thread stopping([&] {
      while (done < 1000)
        std::this_thread::yield();
      work.stop();
    });
    EXPECT_THROW(work.run(endless), WorkStopped);
    stopping.join();
    EXPECT_FALSE(went_on);
    // Neither other work nor loops outside of any are stopped with it.
    std::atomic<int> rows = 0;
    parallel_rows(0, 100, [&](int) { ++rows; });
    StoppableWork other;
    other.run([&] { parallel_rows(0, 100, [&](int) { ++rows; }); });
    EXPECT_EQ(rows, 200);
  }
}

TEST(StoppableWork, ThrowsWhatTheWorkThrows) {
  StoppableWork work, late;
  EXPECT_THROW(work.run([] {
    parallel_rows(0, 9, [](int y) {
      if (y == 3) throw std::runtime_error("row");
    });
  }),
               std::runtime_error);
  late.stop();
  bool began = false;
  EXPECT_THROW(late.run([&] { began = true; }), WorkStopped);
  EXPECT_FALSE(began);
}

TEST(StoppableWork, SortsToTheEnd) {
  StoppableWork work;
  std::vector<int> values(200'000);
  EXPECT_THROW(work.run([&] {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<int>(i * 7919 % values.size());
    work.stop();
    parallel_sort(values, [](int a, int b) { return a < b; });
    parallel_rows(0, 2, [](int) {});
  }),
               WorkStopped);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
}

TEST(TotalOrder, HasAPlaceForNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i)
    values.push_back(i % 3 == 0 ? nan : i % 7);
  std::sort(values.begin(), values.end(), descending);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.begin() + 666, std::greater<>()));
  EXPECT_TRUE(std::all_of(values.begin() + 666, values.end(), [](double v) { return v != v; }));
  std::sort(values.begin(), values.end(), ascending);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.begin() + 666));
  EXPECT_FALSE(ascending(nan, nan) || descending(nan, nan) || ascending(nan, 1.0));
}

TEST(Check, EndsTheProgramOrThrowsItsLine) {
  EXPECT_DEATH(SPOOL_CHECK_GE(-1, 0), "check failed: -1 >= 0 \\(-1 against 0\\)");
  throw_failed_checks();  // of this process: the last test
  try {
    SPOOL_CHECK_LT(3.5, 2);
    FAIL();
  } catch (const std::logic_error& failed) {
    EXPECT_NE(std::string(failed.what()).find("3.5 < 2 (3.5 against 2) (parallel_test.cpp:"),
              std::string::npos)
        << failed.what();
  }
}

}  // namespace
}  // namespace spool
