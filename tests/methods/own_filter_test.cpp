// The C++ filter of docs/own_methods.md, taken from the page when the tests are configured.
#include "lib/filters/median.h"

#include <gtest/gtest.h>

#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

TEST(OwnMethods, TheFilterOfThePageIsAMedian) {
  const SamplePool pool = test::memory_pool(9, 7, 2, [](int x, int y, int) {
    const float value = x == 4 && y == 3 ? 100.0f : 1.0f;  // one bright pixel
    return Rgb{value, 2 * value, 3 * value};
  });
  const Selection all = test::select_uniform(pool, 2);
  const Filter filter = median_filter();
  EXPECT_EQ(filter.needs, Needs{});
  const auto removed = (*filter.make("", {}))(all, pool, FilterContext{});
  ASSERT_TRUE(removed.has_value()) << removed.error().message;
  for (std::size_t c = 0; c < 3; ++c) {
    for (const double value : removed->image[c].pixels())
      EXPECT_EQ(value, static_cast<double>(c + 1));
  }
  const auto kept = (*filter.make("", {{"radius", "0"}}))(all, pool, FilterContext{});
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->image[0](4, 3), 100.0);
  EXPECT_FALSE(filter.make("", {{"radius", "17"}}).has_value());
}

}  // namespace
}  // namespace spool
