// Welch's test as a filter: its parts against slow twins, and what it does by its description.
#include "lib/filters/welch/welch.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/core/student.h"
#include "tests/reference/welch_reference.h"
#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

SamplePool noisy_pool(int width, int height) {
  return test::pool_of(test::memory_recording(width, height, 9, [](int x, int y, int s) {
    const double level = x < 5 ? 0.4 : 1.5;
    Rgb value;
    for (std::size_t c = 0; c < 3; ++c) {
      const double noise = unit_double(mix(5, x, y, s, static_cast<int>(c)));
      value[c] = static_cast<float>(level * (2 * noise - 0.1));  // some below zero
    }
    return value;
  }));
}

CountImage uneven_counts(int width, int height) {
  CountImage n(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      n(x, y) = static_cast<int>(9.99 * unit_double(mix(6, x, y)));
  }
  return n;
}

Image<float> noise(int width, int height, int seed, double low, double high) {
  Image<float> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = static_cast<float>(low + (high - low) * unit_double(mix(seed, i)));
  return image;
}

void expect_near(const Plane& a, const Plane& b, double relative, const std::string& what) {
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_NEAR(a[i], b[i], relative * (1.0 + std::abs(b[i]))) << what << " at " << i;
}

TEST(TransformedMoments, AreThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    const SamplePool pool = noisy_pool(width, height);
    const CountImage n = uneven_counts(width, height);
    for (const double lambda : {1.0, 0.5, 0.25, 0.7, 3.0}) {
      const auto fast = transformed_moments(pool, n, 0.5, lambda, HighestMoment::kFourth);
      const auto slow = reference::transformed_moments(pool, n, 0.5, lambda);
      for (std::size_t c = 0; c < 3; ++c) {
        expect_near(fast.mean[c], slow.mean[c], 1e-13, "mean");
        expect_near(fast.m2[c], slow.m2[c], 1e-12, "m2");
        expect_near(fast.m3[c], slow.m3[c], 1e-12, "m3");
        expect_near(fast.m4[c], slow.m4[c], 1e-12, "m4");
      }
    }
  }
}

TEST(StudentTable, HoldsTheQuantilesOfTheTables) {
  const StudentTable half_percent(0.005);
  EXPECT_NEAR(half_percent(1), 127.3213, 1e-4);
  EXPECT_NEAR(half_percent(6), 4.3168, 1e-4);
  // z + (z^3 + z) / (4 n) with the normal quantile z = 2.80703: the last entry, n = 1024.
  EXPECT_NEAR(half_percent(1e9), 2.81312, 2e-5);
  EXPECT_EQ(half_percent(0), half_percent(1));
  EXPECT_NEAR(half_percent(6.5), 0.5 * (half_percent(6) + half_percent(7)), 1e-12);
  EXPECT_NEAR(StudentTable(0.05)(10), 2.2281, 1e-4);
}

TEST(PairFilter, EqualsItsSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    PairTest test;
    PairFeatures features;
    for (int k = 0; k < 3; ++k) {
      test.mean.push_back(noise(width, height, 10 + k, 0.0, 1.0));
      test.half2.push_back(noise(width, height, 20 + k, 0.01, 0.6));
      features.value.push_back(noise(width, height, 30 + k, 0.0, 2.0));
      features.variance.push_back(noise(width, height, 40 + k, 0.0, 0.1));
    }
    Plane value(width, height);
    for (std::size_t i = 0; i < value.size(); ++i)
      value[i] = unit_double(mix(50, i));
    Image<float> count(width, height);
    const CountImage n = uneven_counts(width, height);
    for (std::size_t i = 0; i < n.size(); ++i)
      count[i] = static_cast<float>(n[i]);
    for (const double kappa : {0.0, 1.0, 10.0, 1e20}) {
      test.kappa = kappa;
      for (const PairWindow& window : {PairWindow{3, 1.0}, PairWindow{10, 5.0}}) {
        const PairMeans fast = pair_filter({&value}, test, features, count, window);
        const PairMeans slow = reference::pair_filter({&value}, test, features, count, window);
        expect_near(fast.value[0], slow.value[0], 2e-6, "value");
        expect_near(fast.weight, slow.weight, 2e-6, "weight");
        expect_near(fast.weight2, slow.weight2, 4e-6, "weight2");
      }
    }
  }
}

// Two halves of a picture, their levels so far apart that no test confuses them, and an edge that
// features do not show.
TEST(Welch, AveragesEqualNeighboursAndStopsAtAnEdge) {
  auto recording = std::make_shared<RecordedSamples>(
      *test::memory_recording(24, 16, 16, [](int x, int y, int s) {
        const double v = (x < 12 ? 1.0 : 30.0) * (0.75 + 0.5 * unit_double(mix(8, x, y, s)));
        const auto f = static_cast<float>(v);
        return Rgb{f, f, f};
      }));
  recording->set_features({}, nullptr);
  const SamplePool pool = test::pool_of(recording);
  const Selection selection = test::select_uniform(pool, 16);
  GuardCounts guards;
  const RgbImage box = pixel_means(selection.statistics, guards);
  for (const std::string preset : {"statmc", "moon", "pooled"}) {
    const auto filter = welch_filter().make(preset, {});
    ASSERT_TRUE(filter.has_value());
    const auto result = (*filter)(selection, pool, FilterContext{});
    ASSERT_TRUE(result.has_value());
    double before = 0.0, after = 0.0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        const double truth = x < 12 ? 1.0 : 30.0;
        // Neighbourhoods of sigma 1 that reach over the edge blur it where pooled means are tested.
        if (preset == "pooled" && x > 8 && x < 15) continue;
        before += std::pow(box[1](x, y) / truth - 1.0, 2);
        after += std::pow(result->image[1](x, y) / truth - 1.0, 2);
      }
    }
    EXPECT_LT(after, 0.25 * before) << preset;
  }
}

// Without variance every difference is refused but none.
TEST(Welch, LeavesExactPixelsAlone) {
  const SamplePool pool = test::pool_of(test::memory_recording(9, 7, 8, [](int x, int y, int) {
    const auto v = static_cast<float>(1 + x + 10 * y);
    return Rgb{v, 2 * v, v};
  }));
  const Selection selection = test::select_uniform(pool, 8);
  for (const std::string preset : {"statmc", "moon"}) {
    const auto result = (*welch_filter().make(preset, {}))(selection, pool, FilterContext{});
    ASSERT_TRUE(result.has_value());
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 9; ++x)
        EXPECT_NEAR(result->image[0](x, y), 1 + x + 10 * y, 1e-9) << preset;
    }
  }
}

TEST(Welch, ANoisyNeighbourExcusesItselfInTheSymmetricTestOnly) {
  // A quiet pixel among noisy brighter ones.
  const SamplePool pool = test::pool_of(test::memory_recording(15, 15, 12, [](int x, int y, int s) {
    const bool quiet = x == 7 && y == 7;
    const double u = unit_double(mix(3, x, y, s));
    const auto v = static_cast<float>(quiet ? 0.1 + 0.001 * u : (u < 0.2 ? 2.0 * u * 5 : 0.1));
    return Rgb{v, v, v};
  }));
  const Selection selection = test::select_uniform(pool, 12);
  const auto at_centre = [&](const std::string& preset) {
    return (*welch_filter().make(preset, {}))(selection, pool, FilterContext{})->image[1](7, 7);
  };
  EXPECT_GT(at_centre("statmc"), 0.12);
  EXPECT_NEAR(at_centre("moon"), 0.1, 0.01);
}

}  // namespace
}  // namespace spool
