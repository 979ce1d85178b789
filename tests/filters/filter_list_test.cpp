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

// Who needs no analysis signal gets the statistics of a selection without one: same image, and as
// many such filters as there are.
TEST(FilterList, FiltersThatNeedNoSignalMakeTheSameImageWithoutIt) {
  const SamplePool pool = testing::make_pool(13, 9, 8, testing::noisy_picture(13, 9, 7));
  const auto count = [](int x, int y) { return 2 + (3 * x + y) % 5; };
  const Selection plain = testing::select_counts(pool, count);
  Selection exposed = plain;
  GuardCounts guards;
  AnalysisSignal signal;
  signal.exposure = exposure_of(plain.statistics, guards);
  set_signal(exposed.statistics, pool, signal);
  ASSERT_NE(signal.exposure, 1.0);
  std::set<std::string> without;
  for (const Filter& entry : filters()) {
    const auto filter = make_method(filters(), {entry.name, "", {}});
    ASSERT_TRUE(filter.has_value());
    if (filter->needs.signal) continue;
    without.insert(entry.name);
    const auto a = filter->run(plain, pool, {}), b = filter->run(exposed, pool, {});
    ASSERT_TRUE(a.has_value() && b.has_value()) << entry.name;
    EXPECT_EQ(a->image, b->image) << entry.name;
  }
  EXPECT_EQ(without, (std::set<std::string>{"box", "gaussian", "nl_means", "twin_guides"}));
  const auto clamped = make_method(filters(), {"box", "", {{"clamp", "on"}}});
  EXPECT_TRUE(clamped->needs.signal);
}

// Who needs no variance makes the same image of means alone, without a variance.
TEST(FilterList, FiltersThatNeedNoVarianceMakeTheSameImageOfMeansAlone) {
  const SamplePool pool = testing::make_pool(13, 9, 8, testing::noisy_picture(13, 9, 7));
  const auto count = [](int x, int y) { return (3 * x + y) % 5; };  // some have none
  const Selection whole = testing::select_counts(pool, count);
  Selection means;
  means.statistics = prefix_means(pool, whole.statistics.n);
  std::set<std::string> without;
  for (const Filter& entry : filters()) {
    const auto filter = make_method(filters(), {entry.name, "", {}});
    ASSERT_TRUE(filter.has_value());
    if (filter->needs.variance) continue;
    without.insert(entry.name);
    FilterContext alone;
    alone.variance = false;
    const auto a = filter->run(whole, pool, {}), b = filter->run(means, pool, alone);
    ASSERT_TRUE(a.has_value() && b.has_value()) << entry.name;
    EXPECT_EQ(a->image, b->image) << entry.name;
    EXPECT_EQ(a->variance.has_value(), entry.name != "twin_guides");  // which never makes one
    EXPECT_FALSE(b->variance.has_value()) << entry.name;
    EXPECT_EQ(filter->needs.pool, entry.name == "twin_guides");
    EXPECT_EQ(a->guards[Guard::kEmptyPiece], b->guards[Guard::kEmptyPiece]);
  }
  EXPECT_EQ(without, (std::set<std::string>{"box", "gaussian", "twin_guides"}));
  for (const auto& [option, value] :
       {std::pair{"clamp", "on"}, {"residual", "halves"}, {"energy", "box"}}) {
    const auto staged = make_method(filters(), {"box", "", {{option, value}}});
    EXPECT_TRUE(staged->needs.variance);
    if (option == std::string("residual")) {
      EXPECT_TRUE(staged->needs.pool);
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
