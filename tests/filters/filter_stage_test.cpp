#include "lib/filters/filter_stage.h"

#include <gtest/gtest.h>

#include "lib/core/pairwise_sum.h"
#include "lib/filters/box.h"
#include "lib/filters/filters.h"
#include "lib/kernels/energy_step.h"
#include "lib/kernels/returned_residual.h"
#include "lib/kernels/sample_clamp.h"
#include "lib/kernels/scene_luminance.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

double sum_of(const Plane& plane) {
  return pairwise_sum(plane.size(), [&](std::size_t i) { return plane[i]; });
}

SamplePool bright_pool() {
  return testing::make_pool(24, 20, 8, [](int x, int y, int s) {
    Rgb value = testing::noisy_picture(24, 20, 4)(x, y, s);
    if (mix(8, x, y, s) % 200 == 0) value = {5000.0f, 5000.0f, 5000.0f};
    return value;
  });
}

Reconstruction run(std::string_view filter, const OptionValues& set, const Selection& selection,
                   const SamplePool& pool) {
  const auto ready = find_method(filters(), filter)->make("", set);
  SPOOL_CHECK(ready.has_value());
  return *(*ready)(selection, pool, FilterContext{});
}

TEST(FilterStage, EveryFilterHasTheOptions) {
  for (const Filter& filter : filters()) {
    for (const char* name : {"clamp", "residual", "energy"}) {
      int found = 0;
      for (const OptionDescription& option : filter.describe(""))
        found += option.name == name ? 1 : 0;
      EXPECT_EQ(found, 1) << filter.name << " " << name;
    }
  }
}

TEST(FilterStage, EnergyIsThatOfTheBoxMean) {
  const SamplePool pool = bright_pool();
  const Selection selection =
      testing::select_counts(pool, [](int x, int y) { return 2 + (x + y) % 7; });
  const RgbImage box = run("box", {}, selection, pool).image;
  for (const char* filter : {"box", "gaussian", "nl_means", "clamped"}) {
    for (const char* clamp : {"off", "on"}) {
      const RgbImage image =
          run(filter, {{"energy", "box"}, {"clamp", clamp}}, selection, pool).image;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum_of(image[c]) / sum_of(box[c]), 1.0, 1e-12) << filter << " " << clamp;
    }
  }
}

// Not of the clamped ones, and before the energy.
TEST(FilterStage, ResidualIsOfTheSamplesTaken) {
  const SamplePool pool = bright_pool();
  const Selection selection = testing::select_uniform(pool, 8);
  GuardCounts guards;
  const double unit = scene_luminance(selection.statistics, guards);
  const RgbImage box = run("box", {}, selection, pool).image;
  for (const char* clamp : {"off", "on"}) {
    const OptionValues plain = {{"sigma", "2"}, {"clamp", clamp}};
    OptionValues with = plain, both = plain;
    with.emplace_back("residual", "halves");
    both.insert(both.end(), {{"residual", "halves"}, {"energy", "box"}});
    const RgbImage filtered = run("gaussian", plain, selection, pool).image;
    const RgbImage returned = return_residual(filtered, selection, pool, unit, guards);
    EXPECT_FALSE(returned == filtered);
    EXPECT_TRUE(run("gaussian", with, selection, pool).image == returned) << clamp;
    EXPECT_TRUE(run("gaussian", both, selection, pool).image ==
                restore_energy(returned, box, unit, {}, guards))
        << clamp;
  }
}

TEST(FilterStage, AClampThatTakesNothingLeavesJoinedHalvesAsTheyAre) {
  const SamplePool pool = testing::make_pool(24, 20, 8, testing::noisy_picture(24, 20, 4));
  const Selection selection = testing::joined_halves(pool);
  const SamplePool first = pool_of_joined(pool, selection);
  const Reconstruction plain = run("box", {}, selection, first);
  const Reconstruction clamped = run("box", {{"clamp", "on"}}, selection, first);
  ASSERT_EQ(clamped.guards[Guard::kClampedSample], 0u);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_LT(reference::max_difference(plain.image[c], clamped.image[c]), 1e-12);
}

// Exhausted pieces have fewer than the others by no decision.
TEST(FilterStage, EnergyOfTheFirstSamplesIsThatOfThoseEveryPieceHas) {
  const SamplePool pool = bright_pool();
  for (const int least : {0, 3}) {
    const Selection selection =
        testing::select_counts(pool, [=](int x, int y) { return least + (x + y) % 9; });
    Selection first = selection;
    if (least > 0) first = testing::select_uniform(pool, least);
    const RgbImage box = run("box", {}, first, pool).image;
    for (const char* clamp : {"off", "on"}) {
      const RgbImage image =
          run("gaussian", {{"energy", "first"}, {"clamp", clamp}}, selection, pool).image;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum_of(image[c]) / sum_of(box[c]), 1.0, 1e-12) << least << " " << clamp;
    }
  }
}

TEST(FilterStage, ClampIsThatOfTheKernelAndIsCounted) {
  const SamplePool pool = bright_pool();
  const Selection selection = testing::select_uniform(pool, 8);
  GuardCounts guards;
  const ClampedSamples clamped = clamp_samples(selection, pool, {}, guards);
  EXPECT_GT(guards[Guard::kClampedSample], 5u);
  for (const char* filter : {"box", "nl_means"}) {
    const Reconstruction staged = run(filter, {{"clamp", "on"}}, selection, pool);
    EXPECT_TRUE(staged.image == run(filter, {}, clamped.selection, clamped.pool).image) << filter;
    EXPECT_EQ(staged.guards[Guard::kClampedSample], guards[Guard::kClampedSample]);
  }
}

// Of a filter that has no unit itself.
TEST(FilterStage, AUnitThatIsMissingIsCounted) {
  const SamplePool pool =
      testing::make_pool(8, 6, 4, [](int, int, int) { return Rgb{-1.0f, -1.0f, -1.0f}; });
  const auto counted = [&](const OptionValues& set) {
    return run("clamped", set, testing::select_uniform(pool, 4), pool)
        .guards[Guard::kExposureFallback];
  };
  EXPECT_EQ(counted({}), 0u);
  EXPECT_EQ(counted({{"energy", "box"}}), 1u);
  EXPECT_EQ(counted({{"residual", "halves"}}), 1u);
}

TEST(FilterStage, OffIsTheFilterItself) {
  const SamplePool pool = bright_pool();
  const Selection selection = testing::select_uniform(pool, 8);
  EXPECT_TRUE(
      run("gaussian", {{"clamp", "off"}, {"residual", "off"}, {"energy", "off"}}, selection, pool)
          .image == run("gaussian", {}, selection, pool).image);
}

TEST(FilterStage, OptionOfTheFilterItselfWins) {
  struct Own {
    bool energy = true;
  };
  const Filter own = with_stage_options(make_value<FilterFunction, Own>(
      {.name = "own",
       .summary = "has an option of that name",
       .options = {switch_option("energy", &Own::energy, "its own")},
       .run = [](const Selection&, const SamplePool&, const Own&,
                 const FilterContext&) -> Result<Reconstruction> { return Reconstruction{}; }}));
  EXPECT_EQ(own.describe("").size(), 3u);
  EXPECT_TRUE(own.make("", {{"energy", "on"}}).has_value());
  EXPECT_FALSE(own.make("", {{"energy", "box"}}).has_value());
}

TEST(FilterStage, OptionsThatOnlyTheFilterKnowsReachIt) {
  Filter secret = box_filter();
  secret.make = [make = secret.make](std::string_view preset, const OptionValues& set) {
    return set == OptionValues{{"hidden", "7"}} ? make(preset, {}) : make(preset, set);
  };
  EXPECT_FALSE(with_stage_options(secret).make("", {{"hidden", "7"}}).has_value());
  const Filter open = with_stage_options(secret, OwnOptions::kKnownWhenMade);
  EXPECT_TRUE(open.make("", {{"hidden", "7"}, {"clamp", "on"}}).has_value());
  EXPECT_FALSE(open.make("", {{"clamps", "on"}}).has_value());
}

TEST(FilterStage, WrongValuesAndUnknownOptionsAreRefused) {
  const Filter box = with_stage_options(box_filter());
  EXPECT_FALSE(box.make("", {{"energy", "all"}}).has_value());
  EXPECT_FALSE(box.make("", {{"clamps", "on"}}).has_value());
}

}  // namespace
}  // namespace spool
