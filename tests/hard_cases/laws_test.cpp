// What happens to a result when its samples are mirrored, turned, scaled, lifted or permuted; each
// law for every method that law_table.h does not name.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "lib/sampling/spending.h"
#include "tests/hard_cases/law_table.h"
#include "tests/hard_cases/moved_world.h"
#include "tests/support/every_method.h"

namespace spool {
namespace {

using test::Law;
using test::World;
using NamedFilter = test::NamedMethod<FilterFunction>;
using NamedSampler = test::NamedMethod<SamplerFunction>;

World drawn_world(int least = 6, int most = 34) {
  const int width = *rc::gen::inRange(least, most), height = *rc::gen::inRange(least, most);
  return test::any_world(width, height, *rc::gen::inRange(3, 9),
                         *rc::gen::arbitrary<std::uint64_t>());
}

// --- the laws, as maps from a place in the old result to the new one ---------------------------

struct Moved {
  World world;
  std::function<double(const RgbImage&, std::size_t c, int x, int y)> expected;
  double tolerance = 1e-9;
  bool rounded = false;  // values are rounded in other places: a weight may cross its threshold
};

Moved if_mirrored(const World& w) {
  return {test::mirrored(w), [=](const RgbImage& was, std::size_t c, int x, int y) {
            return was[c](w.width - 1 - x, y);
          }};
}

Moved if_transposed(const World& w) {
  return {test::transposed(w),
          [](const RgbImage& was, std::size_t c, int x, int y) { return was[c](y, x); }};
}

Moved if_turned(const World& w) {  // by 90 degrees
  return {test::mirrored(test::transposed(w)), [=](const RgbImage& was, std::size_t c, int x,
                                                   int y) { return was[c](y, w.height - 1 - x); }};
}

Moved if_times(const World& w, float factor, double tolerance) {
  return {test::scaled(w, factor),
          [=](const RgbImage& was, std::size_t c, int x, int y) {
            return static_cast<double>(factor) * was[c](x, y);
          },
          tolerance * static_cast<double>(factor)};
}

Moved if_lifted(const World& w, float summand) {
  return {test::lifted(w, summand), [=](const RgbImage& was, std::size_t c, int x, int y) {
            return static_cast<double>(summand) + was[c](x, y);
          }};
}

Moved if_with_channels(const World& w) {
  return {test::with_channels(w, {1, 2, 0}),
          [](const RgbImage& was, std::size_t c, int x, int y) { return was[(c + 1) % 3](x, y); }};
}

Moved if_with_prefix_turned(World w) {
  w.film.clear();
  return {test::with_prefix_turned(w, 1),
          [](const RgbImage& was, std::size_t c, int x, int y) { return was[c](x, y); }};
}

Moved if_shifted(const World& w, int dx, int dy) {
  return {test::shifted(w, dx, dy),
          [=](const RgbImage& was, std::size_t c, int x, int y) { return was[c](x - dx, y - dy); }};
}

// --- filters ----------------------------------------------------------------------------

Reconstruction image_of(const NamedFilter& filter, const World& world) {
  const SamplePool pool = test::record(world);
  const Reference reference = test::mean_of_everything(pool);
  FilterContext context;
  context.reference = &reference;
  auto result = filter.run(test::select(world, pool), pool, context);
  SPOOL_CHECK(result.has_value());
  return std::move(*result);
}

// [pixel] distance from what the law says, `margin` pixels and more from the border.
std::vector<double> distances(const Reconstruction& was, const Moved& moved,
                              const Reconstruction& is, int margin = 0) {
  std::vector<double> of_pixel;
  for (int y = margin; y < is.image[0].height() - margin; ++y) {
    for (int x = margin; x < is.image[0].width() - margin; ++x) {
      double& largest = of_pixel.emplace_back(0.0);
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = std::abs(moved.expected(was.image, c, x, y) - is.image[c](x, y));
        largest = d <= largest ? largest : d;  // NaN counts
      }
    }
  }
  return of_pixel;
}

double largest_of(const std::vector<double>& distances) {
  return std::accumulate(distances.begin(), distances.end(), 0.0, [](double largest, double d) {
    return d <= largest ? largest : d;  // NaN counts
  });
}

double distance(const Reconstruction& was, const Moved& moved, const Reconstruction& is,
                int margin = 0) {
  return largest_of(distances(was, moved, is, margin));
}

double range_of(const RgbImage& image) {
  double range = 0.0;
  for (const Plane& plane : image) {
    double least = plane[0], most = plane[0];
    for (std::size_t i = 0; i < plane.size(); ++i) {
      least = std::min(least, plane[i]);
      most = std::max(most, plane[i]);
    }
    range = std::max(range, most - least);
  }
  return range;
}

// nl_means leaves out weights below 0.05. Rounding moves the pixel of one that lies there, by no
// more than such a weight does; two pixels may be moved.
void expect_jumps(std::vector<double>& distances, const RgbImage& image) {
  for (int i = 0; i < 2; ++i) {
    double& farthest = *std::ranges::max_element(distances);
    RC_ASSERT(farthest <= 0.05 * range_of(image));
    farthest = 0.0;
  }
}

// Directions are computed, features compared and patches summed in float (decision 110), the rest
// in double; twin_guides is float throughout, with a fit of ten coefficients.
double tolerance_of(const NamedFilter& filter, const Moved& moved) {
  const bool in_float =
      filter.name == "directional" || filter.name == "cross_bilateral" || filter.name == "nl_means";
  const bool all_in_float = filter.name == "twin_guides";
  return (all_in_float ? 1e5 : in_float ? 1e3 : 1.0) * moved.tolerance;
}

NamedFilter drawn_filter(Law law, Law other) {
  std::vector<NamedFilter> candidates;
  for (NamedFilter& filter : test::every_filter()) {
    if (test::keeps(test::kFilterExceptions, law, filter.label()) &&
        test::keeps(test::kFilterExceptions, other, filter.label())) {
      candidates.push_back(std::move(filter));
    }
  }
  return candidates[*rc::gen::inRange<std::size_t>(0, candidates.size())];
}

void expect_law(Law law, const World& world, const Moved& moved, Law other) {
  const NamedFilter filter = drawn_filter(law, other);
  RC_LOG() << filter.label() << " " << world.width << " x " << world.height << "\n";
  const Reconstruction was = image_of(filter, world);
  std::vector<double> off = distances(was, moved, image_of(filter, moved.world));
  if (moved.rounded && filter.name == "nl_means") expect_jumps(off, was.image);
  const double d = largest_of(off);
  RC_LOG() << "differs by " << d << "\n";
  RC_ASSERT(d <= tolerance_of(filter, moved));
}

void expect_law(Law law, const World& world, const Moved& moved) {
  expect_law(law, world, moved, law);
}

RC_GTEST_PROP(LawsOfFilters, AMirroredPictureGivesTheMirroredImage, ()) {
  const World world = drawn_world();
  expect_law(Law::kMirror, world, if_mirrored(world));
}

RC_GTEST_PROP(LawsOfFilters, ATransposedPictureGivesTheTransposedImage, ()) {
  const World world = drawn_world();
  expect_law(Law::kTranspose, world, if_transposed(world));
}

RC_GTEST_PROP(LawsOfFilters, APictureTurnedBy90DegreesGivesTheTurnedImage, ()) {
  const World world = drawn_world();
  expect_law(Law::kTranspose, world, if_turned(world), Law::kMirror);
}

RC_GTEST_PROP(LawsOfFilters, APowerOfTwoScalesEveryBit, ()) {
  const World world = drawn_world();
  const int k = *rc::gen::inRange(-100, 41);
  expect_law(Law::kPowerOfTwo, world, if_times(world, std::ldexp(1.0f, k), 0.0));
}

RC_GTEST_PROP(LawsOfFilters, AFactorScalesToRounding, ()) {
  const World world = drawn_world();
  const float factor =
      *rc::gen::elementOf(std::vector<float>{3.0f, 5.0f, 1000.0f, 15.0f * 0x1p20f});
  expect_law(Law::kFactor, world, if_times(world, factor, 1e-9));
}

RC_GTEST_PROP(LawsOfFilters, AConstantAddedIsAddedToTheImage, ()) {
  const World world = drawn_world();
  Moved moved = if_lifted(world, *rc::gen::elementOf(std::vector<float>{0.25f, 1.0f, 2.0f}));
  moved.tolerance = 1e-6;  // the floors of the variance follow the mean
  moved.rounded = true;
  expect_law(Law::kConstant, world, moved);
}

RC_GTEST_PROP(LawsOfFilters, PermutedChannelsArePermutedInTheImage, ()) {
  const World world = drawn_world();
  Moved moved = if_with_channels(world);
  moved.tolerance = 1e-6;  // the floors of the variance follow the luminance
  moved.rounded = true;
  expect_law(Law::kChannels, world, moved);
}

RC_GTEST_PROP(LawsOfFilters, TheOrderOfThePrefixDoesNotMatter, ()) {
  World world = drawn_world();
  world.film.clear();
  expect_law(Law::kPrefixOrder, world, if_with_prefix_turned(world));
}

TEST(LawsOfFilters, AShiftedPictureGivesTheShiftedImageFarFromTheBorder) {
  const World world = test::any_world(88, 86, 4, 3);
  for (const NamedFilter& filter : test::every_filter()) {
    if (!test::keeps(test::kFilterExceptions, Law::kShift, filter.label())) continue;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, -1}, {3, 2}}) {
      const Moved moved = if_shifted(world, dx, dy);
      EXPECT_LE(distance(image_of(filter, world), moved, image_of(filter, moved.world), 36),
                moved.tolerance)  // the same numbers are added in the same order
          << filter.label() << " by " << dx << "," << dy;
    }
  }
}

TEST(LawsOfFilters, ATransposedPictureHasItsDirectionsMapped) {
  const World world = test::any_world(40, 31, 6, 8);
  for (const NamedFilter& filter : test::every_filter()) {
    const Reconstruction was = image_of(filter, world);
    if (!was.dominant_direction) continue;
    const Reconstruction is = image_of(filter, test::transposed(world));
    ASSERT_TRUE(is.dominant_direction.has_value());
    int directed = 0;
    for (int y = 0; y < world.height; ++y) {
      for (int x = 0; x < world.width; ++x) {
        const double a = (*was.dominant_direction)(x, y), b = (*is.dominant_direction)(y, x);
        ASSERT_EQ(std::isnan(a), std::isnan(b)) << filter.label();
        if (std::isnan(a)) continue;
        ++directed;
        const double off = std::remainder(a + b - 90.0, 180.0);
        ASSERT_NEAR(off, 0.0, 0.01) << filter.label() << " " << x << "," << y;
      }
    }
    EXPECT_GT(directed, 0) << filter.label();
  }
}

TEST(LawsOfFilters, OnlySamplesBehindTheCursorAreRead) {
  const World world = test::any_world(21, 18, 8, 77);
  const CountImage n = test::counts_of(world);
  for (const NamedFilter& filter : test::every_filter()) {
    const std::size_t plane = static_cast<std::size_t>(world.width) * world.height * world.spp;
    auto values = std::make_shared<std::vector<float>>(3 * plane);
    const auto write = [&](int from_cursor, float poison) {
      for (int y = 0; y < world.height; ++y) {
        for (int x = 0; x < world.width; ++x) {
          for (int s = from_cursor != 0 ? n(x, y) : 0; s < world.spp; ++s) {
            for (std::size_t c = 0; c < 3; ++c) {
              (*values)[c * plane + (static_cast<std::size_t>(y) * world.width + x) * world.spp +
                        s] = from_cursor != 0 ? poison : world.radiance(x, y, s)[c];
            }
          }
        }
      }
    };
    write(0, 0.0f);
    auto recording = RecordedSamples::create(
        "poison",
        {{world.width, world.height, world.spp, world.width, world.spp}, {values->data()}}, values);
    ASSERT_TRUE(recording.has_value());
    recording->set_pass_film(world.film);
    auto poison_features = std::make_shared<bool>(false);
    test::add_features(*recording, [=](std::string_view layer, std::size_t c, int x, int y, int s) {
      return *poison_features && s >= n(x, y) ? std::numeric_limits<double>::quiet_NaN()
                                              : world.feature(layer, c, x, y, s);
    });
    const SamplePool pool =
        test::pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)));
    const Reference reference = test::mean_of_everything(pool);
    FilterContext context;
    context.reference = &reference;
    const Selection selection = test::select(world, pool);
    const auto clean = filter.run(selection, pool, context);
    // The recording was checked at load; writing to its storage now bypasses every rule.
    write(1, std::numeric_limits<float>::quiet_NaN());
    *poison_features = true;
    const auto poisoned = filter.run(selection, pool, context);
    ASSERT_TRUE(clean.has_value() && poisoned.has_value());
    EXPECT_EQ(poisoned->image, clean->image) << filter.label();
    EXPECT_EQ(poisoned->variance, clean->variance) << filter.label();
    EXPECT_EQ(poisoned->guards, clean->guards) << filter.label();
  }
}

// --- samplers ----------------------------------------------------------------------------------

// A budget that is a whole number of samples a pixel leaves no remainder to spread by index.
CountImage counts_by(const NamedSampler& sampler, const World& world, double spp = 3) {
  const SamplePool pool = test::record(world);
  const auto result =
      sampler.run(pool, sample_budget(spp, pool.recording()), test::sampling_context());
  SPOOL_CHECK(result.has_value());
  return result->selection.statistics.n;
}

// The number of pieces that got another count than the law says.
long long misplaced(const CountImage& was, const Moved& moved, const CountImage& is) {
  RgbImage as_image = make_rgb(was.width(), was.height());
  for (Plane& plane : as_image) {
    for (std::size_t i = 0; i < plane.size(); ++i)
      plane[i] = was[i];
  }
  long long wrong = 0;
  for (int y = 0; y < is.height(); ++y) {
    for (int x = 0; x < is.width(); ++x)
      wrong += moved.expected(as_image, 0, x, y) == is(x, y) ? 0 : 1;
  }
  return wrong;
}

Moved with_counts_as_they_were(Moved moved) {
  moved.expected = [](const RgbImage& was, std::size_t c, int x, int y) { return was[c](x, y); };
  return moved;
}

void expect_sampler_law(Law law, const World& world, const Moved& moved) {
  std::vector<NamedSampler> candidates;
  for (NamedSampler& sampler : test::every_sampler()) {
    if (test::keeps(test::kSamplerExceptions, law, sampler.label()))
      candidates.push_back(std::move(sampler));
  }
  const NamedSampler sampler = candidates[*rc::gen::inRange<std::size_t>(0, candidates.size())];
  RC_LOG() << sampler.label() << " " << world.width << " x " << world.height << "\n";
  RC_ASSERT(misplaced(counts_by(sampler, world), moved, counts_by(sampler, moved.world)) == 0);
}

RC_GTEST_PROP(LawsOfSamplers, APowerOfTwoChangesNoCount, ()) {
  const World world = drawn_world();
  const int k = *rc::gen::inRange(-100, 41);
  expect_sampler_law(Law::kPowerOfTwo, world,
                     with_counts_as_they_were(if_times(world, std::ldexp(1.0f, k), 0.0)));
}

TEST(LawsOfSamplers, AnExactFactorChangesNoCount) {
  // Not a property of every world: priorities that differ in the last bit may change places.
  const World world = test::any_world(33, 24, 9, 5);
  for (const NamedSampler& sampler : test::every_sampler()) {
    if (!test::keeps(test::kSamplerExceptions, Law::kFactor, sampler.label())) continue;
    const CountImage was = counts_by(sampler, world);
    for (const float factor : {3.0f, 1e-6f, 1e6f}) {
      EXPECT_EQ(counts_by(sampler, test::scaled(world, factor)), was)
          << sampler.label() << " " << factor;
    }
  }
}

TEST(LawsOfSamplers, ReplicasAreIdenticalAndWorldsOfEqualSamplesToo) {
  const World world = test::any_world(26, 23, 9, 6);
  for (const NamedSampler& sampler : test::every_sampler())
    EXPECT_EQ(counts_by(sampler, world), counts_by(sampler, world)) << sampler.label();
}

// --- the table ---------------------------------------------------------------------------------

Moved by_law(Law law, const World& w) {
  switch (law) {
    case Law::kMirror:
      return if_mirrored(w);
    case Law::kTranspose:
      return if_transposed(w);
    case Law::kPowerOfTwo:
      return if_times(w, 0x1p20f, 0.0);
    case Law::kFactor:
      return if_times(w, 1000.0f, 1e-9);
    case Law::kConstant:
      return if_lifted(w, 2.0f);
    case Law::kChannels:
      return if_with_channels(w);
    case Law::kPrefixOrder:
      return if_with_prefix_turned(w);
    case Law::kShift:
      return if_shifted(w, 1, 1);
  }
  return {};
}

TEST(LawTable, EveryFilterNamedBreaksItsLaw) {
  for (const test::LawException& named : test::kFilterExceptions) {
    bool known = false, broken = false;
    for (const NamedFilter& filter : test::every_filter()) {
      if (filter.label() != named.method) continue;
      known = true;
      World world =
          named.law == Law::kShift ? test::any_world(88, 86, 4, 3) : test::any_world(33, 24, 6, 5);
      if (named.law == Law::kPrefixOrder) world.film.clear();
      if (filter.name == "clamped") world = test::with_firefly(world);
      const Moved moved = by_law(named.law, world);
      broken = distance(image_of(filter, world), moved, image_of(filter, moved.world),
                        named.law == Law::kShift ? 36 : 0) > tolerance_of(filter, moved);
    }
    EXPECT_TRUE(known) << named.method << " is not a filter any more";
    EXPECT_TRUE(broken) << named.method << " keeps law " << static_cast<int>(named.law);
  }
}

TEST(LawTable, EverySamplerKeepsItsLawOrIsNamed) {
  for (const Law law : {Law::kMirror, Law::kTranspose, Law::kPowerOfTwo, Law::kFactor,
                        Law::kConstant, Law::kChannels}) {
    for (const NamedSampler& sampler : test::every_sampler()) {
      long long wrong = 0;
      for (const int seed : {5, 6}) {
        const World world = test::any_world(33, 24, 12, static_cast<std::uint64_t>(seed));
        Moved moved = by_law(law, world);
        if (law != Law::kMirror && law != Law::kTranspose)
          moved = with_counts_as_they_were(std::move(moved));
        wrong += misplaced(counts_by(sampler, world), moved, counts_by(sampler, moved.world));
        if (test::keeps(test::kSamplerExceptions, law, sampler.label())) continue;
        for (const double spp : {2.51, 5.0}) {
          wrong += misplaced(counts_by(sampler, world, spp), moved,
                             counts_by(sampler, moved.world, spp));
        }
      }
      EXPECT_EQ(wrong == 0, test::keeps(test::kSamplerExceptions, law, sampler.label()))
          << sampler.label() << ", law " << static_cast<int>(law) << ": " << wrong << " pieces";
    }
  }
}

TEST(LawTable, NamesOnlySamplersThatExist) {
  for (const test::LawException& named : test::kSamplerExceptions) {
    bool known = false;
    for (const NamedSampler& sampler : test::every_sampler())
      known = known || sampler.label() == named.method;
    EXPECT_TRUE(known) << named.method;
  }
}

}  // namespace
}  // namespace spool
