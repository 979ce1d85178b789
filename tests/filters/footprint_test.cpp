// Footprints: weights that sum to 1 and make the very pixel, for every filter that has them.
#include "lib/core/footprint.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "tests/filters/small_pools.h"

namespace spool {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

const std::vector<std::pair<int, int>> kPixels = {{0, 0}, {12, 9}, {5, 14}, {22, 18}, {23, 8}};

SamplePool edge_pool(const PoolOptions& options = {}) {
  return testing::make_pool(
      24, 19, 12, testing::noisy_picture(24, 19, 5), options,
      options.pieces_per_side > 1 ? testing::random_film(12) : std::vector<FilmPosition>{});
}

// Some pixels have no sample, many have different counts.
Selection uneven_selection(const SamplePool& pool) {
  return testing::select_counts(pool, [](int x, int y) { return (3 * x + 5 * y) % 7; });
}

struct Told {
  Reconstruction result;
  std::vector<Footprint> footprints;
};

Told tell(const std::string& name, const Settings& set, const SamplePool& pool,
          const Selection& selection) {
  Footprints footprints(kPixels);
  FilterContext context;
  context.footprints = &footprints;
  auto result = (*make_method(filters(), {name, "", set}))(selection, pool, context);
  EXPECT_TRUE(result.has_value()) << name;
  return {std::move(*result), footprints.told()};
}

void expect_pixels_made(const std::string& name, const Told& told) {
  ASSERT_EQ(told.footprints.size(), kPixels.size()) << name;
  for (std::size_t i = 0; i < kPixels.size(); ++i) {
    const Footprint& footprint = told.footprints[i];
    EXPECT_EQ(std::pair(footprint.x, footprint.y), kPixels[i]);
    double weight = 0.0, value[3] = {};
    for (const auto& [place, tap] : footprint.taps) {
      weight += tap.weight;
      for (std::size_t c = 0; c < 3; ++c)
        value[c] += tap.weighted[c];
    }
    EXPECT_NEAR(weight, 1.0, 1e-7) << name;
    for (std::size_t c = 0; c < 3; ++c) {
      const double made = told.result.image[c](footprint.x, footprint.y);
      EXPECT_NEAR(value[c], made, 1e-5 * std::abs(made)) << name << " " << footprint.x;
    }
  }
}

TEST(Footprint, WeightsSumToOneAndMakeThePixelForEveryFilterThatTells) {
  int telling = 0;
  for (const Filter& filter : filters()) {
    if (!filter.footprints) continue;
    ++telling;
    const SamplePool pool = edge_pool();
    expect_pixels_made(filter.name, tell(filter.name, {}, pool, uneven_selection(pool)));
    expect_pixels_made(filter.name, tell(filter.name, {}, pool, testing::select_uniform(pool, 1)));
    const SamplePool pieces = edge_pool({.pieces_per_side = 2});
    expect_pixels_made(filter.name, tell(filter.name, {}, pieces, uneven_selection(pieces)));
  }
  EXPECT_GE(telling, 8);
}

TEST(Footprint, OthersTellNothing) {
  const SamplePool pool = edge_pool();
  for (const Filter& filter : filters()) {
    if (filter.footprints || filter.needs.reference) continue;
    EXPECT_TRUE(tell(filter.name, {}, pool, uneven_selection(pool)).footprints.empty())
        << filter.name;
  }
}

TEST(Footprint, FollowsTheOptionsOfDirectional) {
  const SamplePool pool = edge_pool();
  const Selection selection = uneven_selection(pool);
  for (const Settings& set :
       {Settings{{"base", "none"}}, Settings{{"base", "pixel_gaussian"}},
        Settings{{"anisotropy", "none"}}, Settings{{"weighting", "per_sample"}},
        Settings{{"recon_precision", "float64"}}, Settings{{"clamp", "on"}}}) {
    SCOPED_TRACE(set[0].first + "=" + set[0].second);
    expect_pixels_made("directional", tell("directional", set, pool, selection));
  }
}

TEST(Footprint, FollowsTheOptionsOfWelchAndShrinkage) {
  const SamplePool pool = edge_pool();
  const Selection selection = uneven_selection(pool);
  for (const Settings& set : {Settings{{"pooled", "on"}}, Settings{{"kappa", "0"}},
                              Settings{{"theta", "0"}}, Settings{{"radius", "2"}}}) {
    SCOPED_TRACE(set[0].first + "=" + set[0].second);
    expect_pixels_made("welch", tell("welch", set, pool, selection));
  }
  for (const Settings& set : {Settings{{"levels", "1"}}, Settings{{"lambda", "0"}},
                              Settings{{"lambda", "5"}, {"levels", "6"}}}) {
    SCOPED_TRACE(set[0].first + "=" + set[0].second);
    expect_pixels_made("wavelet_shrinkage", tell("wavelet_shrinkage", set, pool, selection));
  }
  // Nothing is shrunk: the pixel itself.
  for (const Footprint& footprint :
       tell("wavelet_shrinkage", {{"lambda", "0"}}, pool, selection).footprints) {
    for (const auto& [place, tap] : footprint.taps)
      EXPECT_NEAR(tap.weight, place == std::pair(footprint.y, footprint.x) ? 1.0 : 0.0, 1e-9);
  }
}

TEST(Footprint, DirectionalSaysSizeDirectionAndWidths) {
  const SamplePool pool = edge_pool();
  const Told told = tell("directional", {}, pool, uneven_selection(pool));
  for (const Footprint& footprint : told.footprints) {
    ASSERT_EQ(footprint.shapes.size(), 1u);
    const FootprintShape& shape = footprint.shapes[0];
    const int level = (*told.result.level)(footprint.x, footprint.y);
    EXPECT_EQ(shape.size, 1 << level);
    EXPECT_EQ(shape.widths.empty(), level == 0);
    for (const auto& [beta, delta] : shape.widths) {
      EXPECT_GE(beta, 0.0);
      EXPECT_LT(beta, 180.0);
      EXPECT_GE(delta, 0.25);
    }
    // The base image reaches one piece beyond the region.
    for (const auto& [place, tap] : footprint.taps) {
      EXPECT_LE(std::abs(place.second - footprint.x), shape.size / 2 + 1);
      EXPECT_LE(std::abs(place.first - footprint.y), shape.size / 2 + 1);
    }
  }
}

TEST(Footprint, AnImageThatALaterStepChangesHasNone) {
  const SamplePool pool = edge_pool();
  EXPECT_TRUE(tell("box", {{"energy", "box"}}, pool, uneven_selection(pool)).footprints.empty());
}

TEST(Footprint, AskingChangesNoBit) {
  const SamplePool pool = edge_pool();
  const Selection selection = uneven_selection(pool);
  for (const Filter& filter : filters()) {
    if (!filter.footprints) continue;
    const Told told = tell(filter.name, {}, pool, selection);
    const auto alone =
        (*make_method(filters(), {filter.name, "", {}}))(selection, pool, FilterContext{});
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(told.result.image[c].pixels().size(), alone->image[c].pixels().size());
    for (std::size_t i = 0; i < alone->image[0].size(); ++i)
      ASSERT_EQ(told.result.image[0][i], alone->image[0][i]) << filter.name;
  }
}

}  // namespace
}  // namespace spool
