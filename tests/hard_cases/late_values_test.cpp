// Values that are no ordinary numbers and come into the memory of a recording after it was looked
// through: any result or error will do, as long as nothing is read or written beyond its place
// (this test is for the preset asan) and every sampler keeps its budget.
#include <limits>

#include <gtest/gtest.h>

#include "lib/sampling/spending.h"
#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kWidth = 13, kHeight = 11, kSamples = 8;
constexpr std::size_t kChannel = std::size_t{kWidth} * kHeight * kSamples;

// Radiance [c][y][x][s] that a test writes to while the recording has it.
struct WrittenMemory {
  std::vector<float> values = std::vector<float>(3 * kChannel);
  std::shared_ptr<const RecordedSamples> recording;

  WrittenMemory() {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(unit_double(mix(5, i)));
    const LayerGrid grid{kWidth, kHeight, kSamples, std::max(kWidth, kHeight), kSamples};
    auto made = RecordedSamples::create("memory", {grid, {values.data()}}, nullptr);
    SPOOL_CHECK(made.has_value());
    test::add_features(*made);
    recording = std::make_shared<const RecordedSamples>(std::move(*made));
  }
};

struct LateValues {
  float value;
  std::size_t every;  // of the floats
};

class LateValue : public ::testing::TestWithParam<LateValues> {};

TEST_P(LateValue, ReachesNoMemoryButItsOwn) {
  WrittenMemory memory;
  const SamplePool pool = test::pool_of(memory.recording);
  const Reference reference = test::mean_of_everything(pool);
  const Selection before = test::select_uniform(pool, 4);
  const auto [value, every] = GetParam();
  for (std::size_t i = every / 2; i < memory.values.size(); i += every)
    memory.values[i] = value;
  std::vector<Selection> selections = {before, test::select_uniform(pool, 4)};
  for (const auto& sampler : test::every_sampler()) {
    for (const double spp : {2.0, 4.5}) {
      const long long budget = sample_budget(spp, pool.recording());
      const auto sampled = sampler.run(pool, budget, test::sampling_context());
      if (!sampled) continue;
      const CountImage& n = sampled->selection.statistics.n;
      EXPECT_LE(test::total(n), budget) << sampler.label();
      for (const auto count : n.pixels())
        ASSERT_TRUE(count >= 0 && count <= kSamples) << sampler.label();
      if (spp == 4.5 && sampled->selection.halves.empty()) selections.push_back(sampled->selection);
    }
  }
  for (const auto& filter : test::every_filter()) {
    for (const Selection& selection : selections) {
      FilterContext context;
      context.reference = &reference;
      const auto made = filter.run(selection, pool, context);
      if (made) {
        EXPECT_EQ(made->image[0].size(), std::size_t{kWidth} * kHeight) << filter.label();
      }
    }
  }
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

INSTANTIATE_TEST_SUITE_P(Values, LateValue,
                         ::testing::Values(LateValues{kNaN, 3 * kChannel}, LateValues{kNaN, 101},
                                           LateValues{kNaN, 1}, LateValues{kInfinity, 3 * kChannel},
                                           LateValues{kInfinity, 97}, LateValues{kInfinity, 1},
                                           LateValues{-kInfinity, 97}, LateValues{kLargest, 89},
                                           LateValues{kLargest, 1}, LateValues{-kLargest, 89}));

}  // namespace
}  // namespace spool
