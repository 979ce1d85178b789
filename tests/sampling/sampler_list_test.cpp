#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SamplerList, NamesAreUniqueAndDescribed) {
  std::set<std::string> names;
  for (const Sampler& entry : samplers()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.summary.empty()) << entry.name;
    for (const OptionDescription& option : entry.describe("")) {
      EXPECT_FALSE(option.help.empty()) << entry.name << "." << option.name;
      EXPECT_NE(option.value, "?") << entry.name << "." << option.name;
    }
  }
}

TEST(SamplerList, HoldsEverySamplerInReadingOrder) {
  std::vector<std::string> names, by_description;
  for (const Sampler& entry : samplers()) {
    names.push_back(entry.name);
    if (entry.source == Source::kDescriptions) by_description.push_back(entry.name);
  }
  EXPECT_THAT(names, ElementsAre("uniform", "multiscale", "mitchell", "adaptive_wavelet",
                                 "greedy_error", "nl_means", "cross_bilateral", "denoised_variance",
                                 "filtered_halves", "cross_halves", "neyman"));
  EXPECT_THAT(by_description, ElementsAre("mitchell", "adaptive_wavelet", "denoised_variance"));
}

TEST(SamplerList, EveryDefaultOptionCanBeSetToItsOwnValue) {
  for (const Sampler& entry : samplers()) {
    std::vector<std::string> presets = entry.presets;
    presets.push_back("");
    for (const std::string& preset : presets) {
      OptionValues values;
      for (const OptionDescription& option : entry.describe(preset))
        values.emplace_back(option.name, option.value);
      const auto sampler = make_method(samplers(), {entry.name, preset, values});
      EXPECT_TRUE(sampler.has_value()) << entry.name << ": " << sampler.error().message;
    }
  }
}

TEST(SamplerList, UnknownNamesAreUsageErrorsThatNameTheNearest) {
  const auto sampler = make_method(samplers(), {"unifrom", "", {}});
  ASSERT_FALSE(sampler.has_value());
  EXPECT_EQ(sampler.error().code, ErrorCode::kUsage);
  EXPECT_THAT(sampler.error().message, HasSubstr("uniform"));

  const auto option = make_method(samplers(), {"multiscale", "", {{"epoch", "2"}}});
  ASSERT_FALSE(option.has_value());
  EXPECT_EQ(option.error().code, ErrorCode::kUsage);
  EXPECT_THAT(option.error().message, HasSubstr("epochs"));

  const auto preset = make_method(samplers(), {"uniform", "paper", {}});
  ASSERT_FALSE(preset.has_value());
  EXPECT_EQ(preset.error().code, ErrorCode::kUsage);
}

TEST(SamplerList, BudgetRoundsToTheNearestSample) {
  const auto recording =
      test::memory_recording(3, 3, 2, [](int, int, int) { return Rgb{1, 1, 1}; });
  EXPECT_EQ(sample_budget(4.0, *recording), 36);
  EXPECT_EQ(sample_budget(0.5, *recording), 5);
  EXPECT_EQ(sample_budget(0.0, *recording), 0);
}

}  // namespace
}  // namespace spool
