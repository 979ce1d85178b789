#include "lib/metrics/error_metrics.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lib/metrics/error_parts.h"
#include "lib/metrics/largest_first.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::add_noise;
using test::make_image;
using test::uniform_image;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

MetricOptions in_radiance_units() {
  MetricOptions options;
  options.rel_scale = RelativeScale::kNone;
  return options;
}

TEST(ErrorMetrics, TwoPixelsComputedByHand) {
  // I = (1, 3), R = (2, 1) in all channels: errors -1 and 2.
  const RgbImage estimate = make_image(2, 1, [](int x, int, int) { return x == 0 ? 1.0 : 3.0; });
  const JudgingReference reference{
      make_image(2, 1, [](int x, int, int) { return x == 0 ? 2.0 : 1.0; }), {}, {}};
  const MetricTable table = error_metrics(estimate, reference, in_radiance_units());
  EXPECT_DOUBLE_EQ(table["mse"].value, (1.0 + 4.0) / 2);
  EXPECT_DOUBLE_EQ(table["mse_g"].value, 2.5);
  EXPECT_DOUBLE_EQ(table["rmse"].value, std::sqrt(2.5));
  EXPECT_DOUBLE_EQ(table["mae"].value, 1.5);
  EXPECT_DOUBLE_EQ(table["relmse"].value, (1.0 / 4.01 + 4.0 / 1.01) / 2);
  EXPECT_DOUBLE_EQ(table["relmae"].value, (1.0 / 2.01 + 2.0 / 1.01) / 2);
  EXPECT_DOUBLE_EQ(table["smape"].value, (1.0 / 3.01 + 2.0 / 4.01) / 2);
  EXPECT_DOUBLE_EQ(table["relmse_trimmed"].value, 1.0 / 4.01);
  EXPECT_DOUBLE_EQ(table["relmse_dropped"].value, 4.0 / 1.01 / 2);
  EXPECT_DOUBLE_EQ(table["se_max"].value, 4.0);
  EXPECT_DOUBLE_EQ(table["energy_ratio"].value, 4.0 / 3.0);
  // The darker pixel is decile 1, the brighter decile 6 (ranks 0 and 1 of 2).
  EXPECT_DOUBLE_EQ(table["energy_ratio_d1"].value, 3.0);
  EXPECT_DOUBLE_EQ(table["energy_ratio_d6"].value, 0.5);
  EXPECT_TRUE(std::isnan(table["energy_ratio_d10"].value));
}

TEST(ErrorMetrics, RelativeScaleDividesBothImagesByMeanLuminance) {
  const RgbImage estimate = make_image(1, 1, [](int, int, int) { return 6.0; });
  const JudgingReference reference{make_image(1, 1, [](int, int, int) { return 4.0; }), {}, {}};
  const MetricTable table = error_metrics(estimate, reference);
  EXPECT_DOUBLE_EQ(table.relative_scale, 0.25);
  EXPECT_DOUBLE_EQ(table["relmse"].value, 0.25 / 1.01);
  EXPECT_DOUBLE_EQ(table["mse"].value, 4.0);
}

TEST(ErrorMetrics, RelativeOnesOfOtherProgramsAreInRadianceUnits) {
  const RgbImage estimate = make_image(1, 1, [](int, int, int) { return 6.0; });
  const JudgingReference reference{make_image(1, 1, [](int, int, int) { return 4.0; }), {}, {}};
  EXPECT_DOUBLE_EQ(error_metrics(estimate, reference)["relmse_plain"].value, 4.0 / 16.01);
}

TEST(ErrorMetrics, LightThatIsMissingEverywhereAlikeIsNoErrorAtEqualEnergy) {
  const RgbImage r = uniform_image(40, 33, 7, 0.1, 1.0);
  RgbImage third = r, half_of_the_bright = r;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < r[c].size(); ++i)
      third[c][i] /= 3.0;
  }
  const MetricTable all = error_metrics(third, {r, {}, {}});
  EXPECT_GT(all["relmse"].value, 0.3);
  for (const char* name :
       {"mse_equal_energy", "relmse_equal_energy", "mse_equal_deciles", "relmse_equal_deciles"}) {
    EXPECT_NEAR(all[name].value, 0.0, 1e-14) << name;
  }
  // What is lost in one decile only is no error with a factor for each.
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < r[0].size(); ++i)
    order.emplace_back(luminance(r[0][i], r[1][i], r[2][i]), i);
  std::sort(order.begin(), order.end());
  for (std::size_t k = order.size() * 9 / 10; k < order.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c)
      half_of_the_bright[c][order[k].second] /= 2.0;
  }
  const MetricTable bright = error_metrics(half_of_the_bright, {r, {}, {}});
  EXPECT_NEAR(bright["relmse_equal_deciles"].value, 0.0, 1e-14);
  EXPECT_GT(bright["relmse_equal_energy"].value, 1e-3);
}

TEST(ErrorMetrics, ErrorsAtEqualEnergyAreThoseOfAnyScaleOfTheImage) {
  const RgbImage r = uniform_image(40, 33, 7, 0.1, 1.0), i = test::add_noise(r, 4, 0.1);
  const MetricTable expected = error_metrics(i, {r, {}, {}});
  for (const double scale : {1e-15, 1e-9, 1e-6, 0.02, 0.005, 1e3, 1e9}) {
    RgbImage scaled = i;
    for (Plane& plane : scaled) {
      for (double& value : plane.pixels())
        value *= scale;
    }
    const MetricTable found = error_metrics(scaled, {r, {}, {}});
    for (const char* name :
         {"mse_equal_energy", "relmse_equal_energy", "mse_equal_deciles", "relmse_equal_deciles"}) {
      EXPECT_NEAR(found[name].value, expected[name].value, 1e-9 * expected[name].value)
          << name << " " << scale;
    }
  }
}

TEST(ErrorParts, BiasAndVarianceAreThoseOfTheNoise) {
  // Mean 0.3 too low, standard deviation 0.2; the reference's is 0.1.
  constexpr int kSide = 200;
  const RgbImage mu = uniform_image(kSide, kSide, 1, 1.0, 2.0);
  JudgingReference reference{add_noise(mu, 2, 0.1), make_rgb(kSide, kSide, 0.01), {}};
  RgbImage a = add_noise(mu, 3, 0.2), b = add_noise(mu, 4, 0.2);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a[c].size(); ++i) {
      a[c][i] -= 0.3;
      b[c][i] -= 0.3;
    }
  }
  const ErrorParts parts = error_parts(a, b, reference, 1.0);
  // Standard errors: some 0.09 / sqrt(120000) and 0.04 sqrt(2 / 120000).
  EXPECT_NEAR(parts.bias2, 0.09, 0.0015);
  EXPECT_NEAR(parts.variance, 0.04, 0.0007);
  const MetricTable of_a = error_metrics(a, reference), of_b = error_metrics(b, reference);
  EXPECT_NEAR(parts.bias2 + parts.variance, 0.5 * (of_a["mse"].value + of_b["mse"].value), 1e-12);
}

TEST(ErrorMetrics, AnImageHasNoDistanceFromItself) {
  const RgbImage image = uniform_image(40, 33, 7);
  const MetricTable table = error_metrics(image, {image, {}, {}});
  for (const char* name : {"mse", "mse_r", "rmse", "relmse", "relmse_trimmed", "relmse_dropped",
                           "mae", "relmae", "smape", "se_p999", "se_max"}) {
    EXPECT_EQ(table[name].value, 0.0) << name;
  }
  EXPECT_EQ(table["energy_ratio"].value, 1.0);
  EXPECT_EQ(table["psnr_tm"].value, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(table.failed);
}

TEST(ErrorMetrics, SymmetricOnesDoNotCareWhichImageIsTheReference) {
  const RgbImage a = uniform_image(37, 21, 1), b = uniform_image(37, 21, 2);
  const MetricTable forth = error_metrics(a, {b, {}, {}}, in_radiance_units());
  const MetricTable back = error_metrics(b, {a, {}, {}}, in_radiance_units());
  for (const char* name : {"mse", "rmse", "mae", "smape", "se_p999", "se_max"})
    EXPECT_EQ(forth[name].value, back[name].value) << name;
  EXPECT_NE(forth["relmse"].value, back["relmse"].value);
}

TEST(ErrorMetrics, RelativeOnesDoNotDependOnExposure) {
  const RgbImage r = uniform_image(32, 32, 3), i = add_noise(r, 4, 0.1);
  const auto exposed = [](RgbImage image) {
    for (Plane& plane : image) {
      for (double& v : plane.pixels())
        v *= 4096.0;
    }
    return image;
  };
  const MetricTable once = error_metrics(i, {r, {}, {}});
  const MetricTable bright = error_metrics(exposed(i), {exposed(r), {}, {}});
  for (const char* name : {"relmse", "relmse_trimmed", "relmae", "smape", "energy_ratio_d4"})
    EXPECT_EQ(once[name].value, bright[name].value) << name;  // a power of two: to the bit
  EXPECT_EQ(once["mse"].value * 4096.0 * 4096.0, bright["mse"].value);
}

TEST(ErrorMetrics, DebiasingSubtractsTheReferencesVarianceAndMayGoBelowZero) {
  const RgbImage r = uniform_image(16, 16, 5);
  const JudgingReference reference{r, make_rgb(16, 16, 0.25), {}};
  RgbImage near = r;
  near[1](3, 4) += 1e-6;
  const MetricTable table = error_metrics(near, reference, in_radiance_units());
  EXPECT_NEAR(table["mse"].value, -0.25, 1e-12);
  EXPECT_LT(table["relmse"].value, 0.0);
  EXPECT_NEAR(table["rmse"].value, 0.0, 1e-6);
  EXPECT_EQ(error_metrics(r, reference, in_radiance_units())["mse"].value, 0.0);
}

TEST(ErrorMetrics, DenominatorImageReplacesTheReferenceInRelmseOnly) {
  const RgbImage i = make_rgb(4, 4, 3.0), r = make_rgb(4, 4, 1.0);
  const JudgingReference reference{r, {}, make_rgb(4, 4, 2.0)};
  const MetricTable table = error_metrics(i, reference, in_radiance_units());
  EXPECT_DOUBLE_EQ(table["relmse"].value, 4.0 / 4.01);
  EXPECT_DOUBLE_EQ(table["relmae"].value, 2.0 / 1.01);
}

TEST(ErrorMetrics, NonFinitePixelsAreExcludedCountedAndFailTheRunWhenTheyAreInTheImage) {
  RgbImage i = make_rgb(20, 10, 2.0), r = make_rgb(20, 10, 1.0);
  r[1](3, 4) = kNaN;
  r[2](5, 5) = std::numeric_limits<double>::infinity();
  MetricTable table = error_metrics(i, {r, {}, {}});
  EXPECT_FALSE(table.failed);
  EXPECT_EQ(table.excluded_reference, 2u);
  EXPECT_EQ(table.pixels, 198u);
  EXPECT_DOUBLE_EQ(table["mse"].value, 1.0);
  i[0](0, 0) = -std::numeric_limits<double>::infinity();
  table = error_metrics(i, {r, {}, {}});
  EXPECT_TRUE(table.failed);
  EXPECT_EQ(table.excluded_estimate, 1u);
  EXPECT_EQ(table.pixels, 197u);
  EXPECT_DOUBLE_EQ(table["mse"].value, 1.0);
  EXPECT_EQ(table.guards[Guard::kMetricExcluded], 3u);
}

TEST(ErrorMetrics, NothingIsDefinedWithoutPixels) {
  const RgbImage i = make_rgb(3, 2, kNaN), r = make_rgb(3, 2, 1.0);
  const MetricTable table = error_metrics(i, {r, {}, {}});
  EXPECT_TRUE(table.failed);
  for (const MetricValue& value : table.values)
    EXPECT_TRUE(std::isnan(value.value));
}

TEST(ErrorMetrics, BlackReferenceKeepsTheScaleAndCountsIt) {
  const MetricTable table = error_metrics(make_rgb(8, 8, 0.5), {make_rgb(8, 8), {}, {}});
  EXPECT_EQ(table.relative_scale, 1.0);
  EXPECT_EQ(table.guards[Guard::kExposureFallback], 1u);
  EXPECT_DOUBLE_EQ(table["relmse"].value, 0.25 / 0.01);
  EXPECT_TRUE(std::isinf(table["energy_ratio"].value));
}

TEST(ErrorMetrics, TrimmedAndDroppedAddUpToTheWhole) {
  RgbImage r = uniform_image(64, 50, 8), i = add_noise(r, 9, 0.1);
  i[0](10, 10) = 1e4;
  const MetricTable table = error_metrics(i, {r, {}, {}});
  const double n = 64 * 50, dropped = 4;  // ceil(0.001 * 3200)
  EXPECT_NEAR(table["relmse"].value,
              table["relmse_dropped"].value + table["relmse_trimmed"].value * (n - dropped) / n,
              1e-9 * table["relmse"].value);
  EXPECT_LT(table["relmse_trimmed"].value, 0.5);
}

TEST(ErrorMetrics, WhatIsLeftOfOneEnormousErrorIsThatOfTheOthers) {
  const RgbImage r = uniform_image(64, 50, 8, 0.5, 1.5), noisy = add_noise(r, 9, 0.1);
  RgbImage i = noisy;
  i[0](10, 10) = 1e3;
  const MetricValue expected = error_metrics(i, {r, {}, {}})["relmse_trimmed"];
  for (const double firefly : {1e5, 1e7, 1e9, 1e12, 1e15, 1e200}) {
    i[0](10, 10) = firefly;
    const MetricValue found = error_metrics(i, {r, {}, {}})["relmse_trimmed"];
    EXPECT_NEAR(found.value, expected.value, 1e-9 * expected.value) << firefly;
    EXPECT_NEAR(found.standard_error, expected.standard_error, 1e-9 * expected.standard_error)
        << firefly;
  }
}

TEST(ErrorMetrics, EveryMetricHasOneName) {
  for (std::size_t m = 0; m < metrics().size(); ++m)
    EXPECT_EQ(metric_index(metrics()[m].name), static_cast<int>(m));
  EXPECT_EQ(metric_index("nonsense"), -1);
}

TEST(SquaredErrorMap, AveragesToMse) {
  const RgbImage r = uniform_image(20, 20, 11), i = add_noise(r, 12, 0.3);
  const JudgingReference reference{r, make_rgb(20, 20, 0.01), {}};
  const Plane map = squared_error_map(i, reference);
  double sum = 0.0;
  for (const double v : map.pixels())
    sum += v;
  EXPECT_NEAR(sum / 400, error_metrics(i, reference)["mse"].value, 1e-14);
}

TEST(LargestFirst, WalksEveryPixelInDescendingOrderThoughOnlyTheHeadIsSorted) {
  Plane values(70, 70);
  for (std::size_t p = 0; p < values.size(); ++p)
    values[p] = std::floor(100.0 * test::uniform(3, p));
  LargestFirst order(values, Image<std::uint8_t>(70, 70, 1));
  LargestFirst::Entry last{1e300, 0};
  std::size_t visited = 0;
  order.walk([&](const LargestFirst::Entry& entry) {
    EXPECT_TRUE(entry.value < last.value ||
                (entry.value == last.value && entry.pixel > last.pixel));
    last = entry;
    ++visited;
    return true;
  });
  EXPECT_EQ(visited, values.size());
}

TEST(ErrorMetrics, ThoseThatAreWantedHaveTheSameBitsAndTheOthersNone) {
  const RgbImage r = make_rgb(40, 33, 0.5);
  RgbImage i = r;
  for (std::size_t p = 0; p < i[0].size(); ++p)
    i[p % 3][p] += 0.001 * static_cast<double>(p % 17);
  MetricOptions options;
  options.perceptual = Perceptual::kAll;
  const MetricTable all = error_metrics(i, {r, {}, {}}, options);
  for (std::size_t m = 0; m < metrics().size(); ++m) {
    options.wanted.assign(metrics().size(), false);
    options.wanted[m] = true;
    const MetricTable one = error_metrics(i, {r, {}, {}}, options);
    for (std::size_t other = 0; other < metrics().size(); ++other) {
      const MetricValue& expected = other == m ? all.values[m] : MetricValue{};
      const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
      EXPECT_EQ(bits(one.values[other].value), bits(expected.value)) << metrics()[other].name;
      EXPECT_EQ(bits(one.values[other].standard_error), bits(expected.standard_error))
          << metrics()[other].name;
    }
    EXPECT_EQ(one.resampled[m].size(), all.resampled[m].size()) << metrics()[m].name;
  }
}

// The first image has a pixel that is no number: its side is of fewer pixels than that of others.
TEST(KeptSide, ChangesNoBit) {
  JudgingReference plain{uniform_image(40, 30, 3, 0.0, 2.0), {}, {}};
  JudgingReference kept = plain;
  kept.kept = std::make_shared<KeptSide>();
  for (const std::uint64_t seed : {1, 2, 4, 1}) {
    RgbImage image = uniform_image(40, 30, seed, 0.0, 2.0);
    if (seed == 1) image[1](7, 5) = kNaN;
    const MetricTable a = error_metrics(image, plain), b = error_metrics(image, kept);
    const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
    for (std::size_t m = 0; m < a.values.size(); ++m) {
      const std::string& name = metrics()[m].name;
      EXPECT_EQ(bits(a.values[m].value), bits(b.values[m].value)) << name;
      EXPECT_TRUE(std::ranges::equal(a.resampled[m], b.resampled[m], {}, bits, bits)) << name;
    }
    EXPECT_EQ(a.flip, b.flip);
    EXPECT_EQ(a.flip(7, 5) == 0.0, seed == 1);
  }
}

}  // namespace
}  // namespace spool
