#include "lib/sampling/priority_order.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random_images.h"

namespace spool {
namespace {

// Every entry of positive priority, sorted at once.
std::vector<RegionEntry> all_sorted(const std::vector<Plane>& priorities) {
  std::vector<RegionEntry> all;
  for (std::size_t k = 0; k < priorities.size(); ++k) {
    for (int y = 0; y < priorities[k].height(); ++y) {
      for (int x = 0; x < priorities[k].width(); ++x) {
        if (priorities[k](x, y) > 0.0)
          all.push_back({static_cast<int>(k), x, y, priorities[k](x, y)});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(), precedes);
  return all;
}

void expect_the_whole_order(const std::vector<Plane>& priorities, std::size_t expected) {
  const PriorityMaxima<double> maxima(priorities, 0);
  PriorityOrder<double> order(maxima, expected, [](const RegionEntry&) { return true; });
  for (const RegionEntry& want : all_sorted(priorities))
    ASSERT_EQ(order.next(), want);
  EXPECT_EQ(order.next(), std::nullopt);
  EXPECT_EQ(order.next(), std::nullopt);
}

std::vector<Plane> pyramid_of(int width, int height, double (*value)(std::uint64_t, int, int)) {
  std::vector<Plane> planes;
  for (std::uint64_t level = 0; level < 4; ++level) {
    Plane plane(std::max(1, width >> level), std::max(1, height >> level));
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x)
        plane(x, y) = value(level, x, y);
    }
    planes.push_back(std::move(plane));
  }
  return planes;
}

double heavy_tailed(std::uint64_t level, int x, int y) {
  const double u = test::uniform(11, level, static_cast<std::uint64_t>(1000 * y + x));
  return u < 0.3 ? 0.0 : 1.0 / (1.0001 - u);
}

// Larger than what is sampled to find where batches are cut, so that there are many.
TEST(PriorityOrder, IsTheSortedOrderHoweverManyAreExpected) {
  const std::vector<Plane> priorities = pyramid_of(160, 90, heavy_tailed);
  for (const std::size_t expected : {0u, 1u, 100u, 20000u, 1000000u})
    expect_the_whole_order(priorities, expected);
}

TEST(PriorityOrder, OfEqualPriorities) {
  expect_the_whole_order(pyramid_of(160, 90, [](std::uint64_t, int, int) { return 0.25; }), 10);
  expect_the_whole_order(
      pyramid_of(160, 90, [](std::uint64_t, int x, int) { return x % 3 == 0 ? 2.0 : 1.0; }), 10);
}

TEST(PriorityOrder, OfOneEntryAndOfNone) {
  expect_the_whole_order({Plane(1, 1, 3.0)}, 1);
  expect_the_whole_order({Plane(70, 70, 0.0)}, 5);
  expect_the_whole_order({}, 5);
}

// Entries that stop being free on the way are left out, the others keep their order.
TEST(PriorityOrder, LeavesOutWhatIsNotFree) {
  const std::vector<Plane> priorities = pyramid_of(160, 90, heavy_tailed);
  const PriorityMaxima<double> maxima(priorities, 0);
  std::size_t taken = 0;
  PriorityOrder<double> order(maxima, 50,
                              [&](const RegionEntry& e) { return e.x % 4 != 0 || taken < 99; });
  for (const RegionEntry& want : all_sorted(priorities)) {
    if (want.x % 4 == 0 && taken >= 99) continue;
    ASSERT_EQ(order.next(), want);
    ++taken;
  }
  EXPECT_EQ(order.next(), std::nullopt);
}

}  // namespace
}  // namespace spool
