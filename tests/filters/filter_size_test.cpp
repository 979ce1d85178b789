#include "lib/filters/directional/filter_size.h"

#include <limits>

#include <gtest/gtest.h>

#include "lib/filters/directional/size_factor.h"
#include "lib/filters/directional/stop_votes.h"
#include "tests/filters/directional_cases.h"
#include "tests/reference/filter_size_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using testing::SizeCase;

SizeCase flat_case(int width, int height, double mean, double variance) {
  SizeCase c = testing::random_size_case(width, height, 1);
  c.mean = Plane(width, height, mean);
  c.variance = Plane(width, height, variance);
  c.attenuation.clear();
  return c;
}

CountImage size_of(const SizeCase& c, const FilterSizeOptions& options) {
  GuardCounts guards;
  return filter_size(c.input(), options, nullptr, guards);
}

int level_count(const CountImage& level, int k) {
  int count = 0;
  for (const int l : level.pixels())
    count += l == k ? 1 : 0;
  return count;
}

TEST(CautiousVariance, HasTheBitsOfTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 5}, {3, 3}, {37, 20}}) {
    const Plane variance = reference::noise_image(width, height, 4);
    EXPECT_EQ(cautious_variance(variance), reference::cautious_variance(variance));
  }
}

TEST(FilterSize, AFlatNoisyImageTakesTheLargestFilterEverywhere) {
  const SizeCase c = flat_case(40, 30, 0.7, 0.01);
  EXPECT_EQ(level_count(size_of(c, {}), 4), 40 * 30);
}

TEST(FilterSize, ACleanEdgeStopsTheSizeBesideItAndNotFarAway) {
  SizeCase c = flat_case(64, 64, 0.0, 1e-8);
  for (int y = 0; y < 64; ++y) {
    for (int x = 32; x < 64; ++x)
      c.mean(x, y) = 1.0;
  }
  FilterSizeOptions options;
  for (const auto smooth : {SizeSmooth::kOpensOnly, SizeSmooth::kOn, SizeSmooth::kOff}) {
    options.smooth = smooth;
    const CountImage level = size_of(c, options);
    EXPECT_LE(level(31, 32), 2);
    EXPECT_LE(level(33, 32), 2);
    EXPECT_EQ(level(8, 32), 4);
    EXPECT_EQ(level(56, 32), 4);
  }
}

TEST(FilterSize, VotesOfTheNeighboursDoNotKeepAFirefly) {
  // A clean slope, where everybody stops at once, but for one piece that knows how little it knows.
  SizeCase c = flat_case(48, 48, 0.0, 1e-9);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x)
      c.mean(x, y) = 0.02 * (x + y);
  }
  c.mean(24, 24) = 50.0;
  c.variance(24, 24) = 1e5;
  FilterSizeOptions options;
  EXPECT_EQ(size_of(c, options)(10, 10), 0);
  EXPECT_GT(size_of(c, options)(24, 24), 0);
  options.smooth = SizeSmooth::kOn;
  EXPECT_EQ(size_of(c, options)(24, 24), 0);
}

TEST(FilterSize, AloneAPieceCannotStopAgainstItsNeighbours) {
  SizeCase c = flat_case(48, 48, 0.5, 0.01);
  c.variance(20, 20) = 1e-9;  // looks certain by chance
  c.mean(20, 20) = 0.62;
  FilterSizeOptions off;
  off.smooth = SizeSmooth::kOff;
  EXPECT_EQ(size_of(c, off)(20, 20), 0);
  EXPECT_GT(size_of(c, {})(20, 20), 0);
}

TEST(FilterSize, NoVoteOverrulesALamp) {
  // An even wall and a lamp in one piece: of the regions that begin at the lamp's neighbours only
  // those to its right and below hold it, so most neighbours see nothing.
  SizeCase c = flat_case(48, 48, 0.28, 1e-4);
  c.mean(24, 24) = 968.0;
  c.variance(24, 24) = 1.0;
  FilterSizeOptions deaf;
  deaf.evidence = 0.0;
  EXPECT_GT(size_of(c, deaf)(25, 25), 0);
  const CountImage level = size_of(c, {});
  EXPECT_EQ(level(25, 25), 0);
  EXPECT_EQ(level(24, 25), 0);
  EXPECT_EQ(level(24, 24), 0);
  EXPECT_GT(level(10, 10), 2);
  c.variance(24, 24) = 968.0 * 968.0;  // a firefly: one sample, as uncertain as it is bright
  EXPECT_GT(size_of(c, {})(24, 24), 0);
}

TEST(FilterSize, ASmallerFactorNeverMakesAFilterSmallerWithoutVotes) {
  const SizeCase c = testing::random_size_case(33, 21, 5);
  FilterSizeOptions options;
  options.smooth = SizeSmooth::kOff;
  CountImage before = size_of(c, options);
  for (const double z : {0.3, 0.1, 0.05, 0.0}) {
    options.factor.constant = z;
    const CountImage level = size_of(c, options);
    for (std::size_t i = 0; i < level.size(); ++i)
      EXPECT_GE(level[i], before[i]);
    before = level;
  }
}

TEST(FilterSize, WithoutAttenuationTheLiteralFormsUseOneTenth) {
  SizeCase c = testing::random_size_case(24, 24, 6);
  c.attenuation.clear();
  FilterSizeOptions constant;
  constant.factor.constant = 0.10;
  for (const auto rule : {SizeFactorRule::kLiteral, SizeFactorRule::kLiteralClamped}) {
    FilterSizeOptions literal;
    literal.factor.rule = rule;
    GuardCounts guards;
    EXPECT_EQ(filter_size(c.input(), literal, nullptr, guards), size_of(c, constant));
    EXPECT_EQ(guards[Guard::kSizeFactorFallback], 4u * 24 * 24);
  }
}

TEST(FilterSize, UntouchedAttenuationFallsBack) {
  SizeCase c = testing::random_size_case(16, 16, 7);
  for (Plane& a : c.attenuation)
    a = Plane(16, 16, 1.0);
  FilterSizeOptions literal, constant;
  literal.factor.rule = SizeFactorRule::kLiteralClamped;
  constant.factor.constant = literal.factor_fallback;
  EXPECT_EQ(size_of(c, literal), size_of(c, constant));
}

TEST(FilterSize, ANonFiniteCriterionStopsAndIsCounted) {
  SizeCase infinite = flat_case(16, 16, 0.5, 0.01);
  infinite.mean(8, 8) = 1e200;  // squared: infinite
  SizeCase not_a_number = flat_case(16, 16, 0.5, 0.01);
  not_a_number.variance(8, 8) = std::numeric_limits<double>::infinity();  // at both sizes
  FilterSizeOptions options;
  options.smooth = SizeSmooth::kOff;
  for (const SizeCase& c : {infinite, not_a_number}) {
    GuardCounts guards;
    const CountImage level = filter_size(c.input(), options, nullptr, guards);
    EXPECT_EQ(level(8, 8), 0);
    EXPECT_GT(guards[Guard::kSizeNotFinite], 0u);
  }
}

TEST(FilterSize, StepsToTheNeighboursAreLimitedAsTheTwinSays) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {17, 16}, {40, 33}}) {
    const SizeCase c = testing::random_size_case(width, height, 8);
    for (const int step : {1, 2}) {
      FilterSizeOptions limited;
      limited.step = step;
      EXPECT_EQ(size_of(c, limited), reference::limited_steps(size_of(c, {}), step));
    }
  }
}

TEST(FilterSize, ALoneLargeFilterOnADiagonalEdgeIsClosedToOneStepAboveItsNeighbours) {
  SizeCase c = flat_case(48, 48, 0.0, 1e-8);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x)
      c.mean(x, y) = x == y ? 0.5 : (x > y ? 0.8 : 0.2);
  }
  FilterSizeOptions open, closed;
  open.evidence = closed.evidence = 0.0;  // which would see the edge from the next regions
  closed.step = 1;
  const CountImage open_level = size_of(c, open), closed_level = size_of(c, closed);
  for (int i = 16; i < 32; ++i) {
    EXPECT_EQ(open_level(i, i), 4);  // its mean is 0.5 at every size
    const int beside = std::max(open_level(i + 1, i), open_level(i, i + 1));
    EXPECT_LE(beside, 1);  // these see the edge at once; their votes alone are too few at size 1
    EXPECT_EQ(closed_level(i, i), beside + 1);
    EXPECT_EQ(closed_level(i + 1, i), open_level(i + 1, i));
  }
}

TEST(FilterSize, GreedyCautionHasItsKnownValues) {
  EXPECT_NEAR(greedy_caution(0.05), 0.21, 0.005);
  EXPECT_NEAR(greedy_caution(0.2), 0.70, 0.005);
  EXPECT_NEAR(greedy_caution(0.5), 3.33, 0.01);
}

TEST(FilterSize, ViewsAreKeptOnlyWhenAskedFor) {
  const SizeCase c = testing::random_size_case(8, 8, 9);
  GuardCounts guards;
  Views none, some({"T.2", "stop"});
  filter_size(c.input(), {}, &none, guards);
  filter_size(c.input(), {}, &some, guards);
  EXPECT_TRUE(none.collected().empty());
  ASSERT_EQ(some.collected().size(), 5u);  // T.2 and stop.0 .. stop.3
}

}  // namespace
}  // namespace spool
