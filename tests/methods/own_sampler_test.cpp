// The C++ sampler of docs/own_methods.md, taken from the page when the tests are configured.
#include "lib/sampling/two_stage.h"

#include <gtest/gtest.h>

#include "lib/sampling/uniform.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

TEST(OwnMethods, TheSamplerOfThePageGoesWhereSamplesDiffer) {
  const SamplePool pool = test::memory_pool(8, 6, 32, [](int x, int, int s) {
    const float value = x < 4 ? 1.0f : static_cast<float>(s % 2);  // quiet on the left
    return Rgb{value, value, value};
  });
  const long long budget = 8LL * 6 * 8;
  const Sampler sampler = two_stage_sampler();
  EXPECT_EQ(sampler.needs, Needs{});
  const auto taken = (*sampler.make("", {}))(pool, budget, SamplingContext{});
  ASSERT_TRUE(taken.has_value()) << taken.error().message;
  EXPECT_EQ(taken->log.initial, budget / 2);
  EXPECT_EQ(taken->log.spent, budget);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(taken->selection.statistics.n(x, y), x < 4 ? 4 : 12);
  }
  const auto even = (*sampler.make("", {{"first", "1"}}))(pool, budget, SamplingContext{});
  const auto uniform = (*uniform_sampler().make("", {}))(pool, budget, SamplingContext{});
  EXPECT_EQ(even->selection.statistics.n, uniform->selection.statistics.n);
}

}  // namespace
}  // namespace spool
