#include "lib/filters/filters.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/filters/small_pools.h"

namespace spool {
namespace {

TEST(FilterList, NamesAreUniqueAndEveryEntryCanBeMade) {
  std::set<std::string> names;
  for (const Filter& entry : filters()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.summary.empty()) << entry.name;
    EXPECT_TRUE(make_method(filters(), {entry.name, "", {}}).has_value()) << entry.name;
    for (const std::string& preset : entry.presets) {
      EXPECT_TRUE(make_method(filters(), {entry.name, preset, {}}).has_value()) << preset;
    }
  }
}

TEST(FilterList, EveryDescribedValueCanBeSetAgain) {
  for (const Filter& entry : filters()) {
    std::vector<std::string> presets = entry.presets;
    presets.push_back("");
    for (const std::string& preset : presets) {
      for (const OptionDescription& option : entry.describe(preset)) {
        EXPECT_TRUE(
            make_method(filters(), {entry.name, preset, {{option.name, option.value}}}).has_value())
            << entry.name << " " << option.name << " = " << option.value;
      }
    }
  }
}

TEST(FilterList, UnknownNamesAreUsageErrorsThatNameTheNearest) {
  const auto filter = make_method(filters(), {"bxo", "", {}});
  ASSERT_FALSE(filter.has_value());
  EXPECT_EQ(filter.error().code, ErrorCode::kUsage);
  EXPECT_EQ(filter.error().message, "unknown filter 'bxo', did you mean 'box'?");
  const auto option = make_method(filters(), {"nl_means", "", {{"var_mod", "raw"}}});
  ASSERT_FALSE(option.has_value());
  EXPECT_EQ(option.error().message,
            "filter nl_means: unknown option 'var_mod', did you mean 'var_mode'?");
  const auto preset = make_method(filters(), {"box", "fast", {}});
  ASSERT_FALSE(preset.has_value());
  EXPECT_EQ(preset.error().code, ErrorCode::kUsage);
}

TEST(FilterList, AllAcceptABareSelectionOfEverySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 1}, {5, 4}, {33, 17}}) {
    const SamplePool pool =
        testing::make_pool(width, height, 4, testing::noisy_picture(width, height, 7));
    for (const int spp : {1, 4}) {
      const Selection selection = testing::select_uniform(pool, spp);
      for (const Filter& entry : filters()) {
        const auto filter = make_method(filters(), {entry.name, "", {}});
        ASSERT_TRUE(filter.has_value());
        const Reference reference{selection.statistics.mean, std::nullopt};
        FilterContext context;
        context.reference = &reference;  // for oracles
        const auto result = (*filter)(selection, pool, context);
        ASSERT_TRUE(result.has_value()) << entry.name << ": " << result.error().message;
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_EQ(result->image[c].width(), width);
          ASSERT_EQ(result->image[c].height(), height);
          for (const double v : result->image[c].pixels())
            ASSERT_TRUE(std::isfinite(v)) << entry.name;
          if (!result->variance) continue;
          for (const double v : (*result->variance)[c].pixels())
            ASSERT_TRUE(std::isfinite(v) && v >= 0.0) << entry.name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace spool
