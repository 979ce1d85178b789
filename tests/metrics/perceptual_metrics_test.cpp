#include "lib/metrics/perceptual_metrics.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/metrics/error_metrics.h"
#include "lib/metrics/flip.h"
#include "lib/metrics/structural_similarity.h"
#include "lib/metrics/tone_map.h"
#include "tests/reference/structural_similarity_reference.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::make_image;
using test::uniform_image;

double mean_of(const Plane& map) {
  double sum = 0.0, n = 0.0;
  for (const double v : map.pixels()) {
    if (std::isfinite(v)) sum += v, n += 1.0;
  }
  return sum / n;
}

// The images of perceptual_golden.py.
RgbImage golden_image(bool noisy, bool hdr) {
  return make_image(100, 80, [&](int x, int y, int c) {
    const double base = 0.1 + 0.8 * ((x / 9 + y / 7) % 2) * (c + 1) / 3;
    const double noise = (x * 7919 + y * 104729 + c * 15485863) % 1009 / 1009.0 - 0.5;
    const double scale = hdr ? std::exp2(y / 10.0 - 4) : 1.0;
    return scale * (noisy ? std::max(base + 0.3 * noise, 0.0) : base);
  });
}

Plane luma(const RgbImage& image) {
  Plane result(image[0].width(), image[0].height());
  for (std::size_t p = 0; p < result.size(); ++p) {
    result[p] = luminance(tone_mapped(image[0][p], 1.0), tone_mapped(image[1][p], 1.0),
                          tone_mapped(image[2][p], 1.0));
  }
  return result;
}

// Golden values by scikit-image 0.26 and flip-evaluator 1.7 (float inside): perceptual_golden.py.
TEST(Ssim, EqualsScikitImage) {
  const SimilarityMaps maps =
      ssim_maps(luma(golden_image(true, false)), luma(golden_image(false, false)));
  EXPECT_NEAR(mean_of(maps.ssim), 0.8723405341, 1e-9);
}

TEST(Flip, EqualsTheAuthorsProgram) {
  EXPECT_NEAR(mean_of(flip_ldr_map(golden_image(false, false), golden_image(true, false))),
              0.1166255, 3e-6);
}

TEST(Flip, HighDynamicRangeEqualsTheAuthorsProgram) {
  const RgbImage reference = golden_image(false, true);
  const FlipExposures exposures = *flip_exposures(reference);
  EXPECT_NEAR(exposures.start, -2.0698287, 1e-3);
  EXPECT_NEAR(exposures.stop, 3.2052252, 1e-3);
  EXPECT_EQ(exposures.count, 6);
  EXPECT_NEAR(mean_of(*flip_hdr_map(reference, golden_image(true, true))), 0.2500319, 1e-5);
}

TEST(Flip, IsZeroBetweenEqualImagesAndWithinOneAlways) {
  const RgbImage a = uniform_image(30, 20, 1);
  const Plane same = flip_ldr_map(a, a);  // named: a range-for would outlive the temporary
  for (const double v : same.pixels())
    EXPECT_EQ(v, 0.0);
  for (const Plane& map : {flip_ldr_map(a, uniform_image(30, 20, 2)),
                           flip_ldr_map(make_rgb(30, 20, 0.0), make_rgb(30, 20, 1.0)),
                           *flip_hdr_map(a, make_rgb(30, 20, 1e6))}) {
    for (const double v : map.pixels()) {
      EXPECT_GE(v, 0.0);
      EXPECT_LE(v, 1.0 + 1e-12);
    }
  }
}

TEST(ToneMap, TheExposureFollowsTheUnitOfRadiance) {
  const auto exposed = [](double unit) {
    RgbImage image = golden_image(true, true);
    for (Plane& plane : image) {
      for (double& v : plane.pixels())
        v *= unit;
    }
    return unit * tone_map_exposure(image, {});
  };
  EXPECT_NEAR(exposed(1e-8), exposed(1e-20), 1e-12);
  EXPECT_NEAR(exposed(1e8), exposed(1e20), 1e-12);
  EXPECT_NEAR(exposed(1e-8), exposed(1.0), 0.2 * exposed(1.0));  // a floor of 1e-2 of the mean
  EXPECT_NEAR(exposed(1e8), exposed(1.0), 0.02 * exposed(1.0));
}

TEST(Flip, LowDynamicRangeIsSymmetric) {
  const RgbImage a = uniform_image(30, 20, 1), b = uniform_image(30, 20, 2);
  EXPECT_EQ(flip_ldr_map(a, b), flip_ldr_map(b, a));
}

TEST(Flip, HighDynamicRangeDoesNotDependOnExposure) {
  RgbImage r = golden_image(false, true), t = golden_image(true, true);
  const double once = mean_of(*flip_hdr_map(r, t));
  for (RgbImage* image : {&r, &t}) {
    for (Plane& plane : *image) {
      for (double& v : plane.pixels())
        v *= 0x1p10;
    }
  }
  EXPECT_NEAR(mean_of(*flip_hdr_map(r, t)), once, 1e-9);
}

TEST(Flip, AnyFiniteRangeHasABoundedNumberOfExposures) {
  RgbImage wide = make_rgb(8, 8, 1e-25);
  for (Plane& plane : wide)
    plane[63] = 1e25;
  const FlipExposures exposures = *flip_exposures(wide);
  EXPECT_EQ(exposures.count, kMostFlipExposures);
  EXPECT_NEAR(exposures.stop - exposures.start, 50 * std::log2(10.0), 1e-9);  // all of the range
  RgbImage ordinary = make_rgb(8, 8, 1.0);
  for (Plane& plane : ordinary)
    plane[63] = 0x1p16;
  EXPECT_EQ(flip_exposures(ordinary)->count, 16);  // one for each stop, as the authors have it
  RgbImage other = wide;
  other[0][5] = 1e10;
  EXPECT_GT(mean_of(*flip_hdr_map(wide, other)), 0.0);
}

TEST(Flip, BlackReferenceHasNoExposures) {
  EXPECT_FALSE(flip_hdr_map(make_rgb(8, 8), make_rgb(8, 8, 1.0)).has_value());
  RgbImage mostly_black = make_rgb(8, 8);
  mostly_black[1](3, 3) = 0.5;
  mostly_black[1](4, 3) = 2.0;
  const FlipExposures exposures = *flip_exposures(mostly_black);
  EXPECT_NEAR(exposures.stop - exposures.start, 2.0, 1e-12);
}

// A dark strip, a grey field and a lamp; the image has noise in the strip.
RgbImage strip_and_lamp(int height, bool noisy) {
  return make_image(96, height, [&](int x, int y, int) {
    const double noise = noisy ? ((x * 7919 + y * 104729) % 1009 < 500 ? 0.3 : 1.7) : 1.0;
    return x == 90 && y == 0 ? 30.0 : x < 24 ? 1e-3 * noise : 1.0;
  });
}

TEST(Flip, PixelsThatAreNotJudgedDoNotChooseTheExposures) {
  RgbImage reference = strip_and_lamp(96, false);
  Image<std::uint8_t> judged(96, 96);
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 96; ++x)
      judged(x, y) = 1;
  }
  const RgbImage zeroed = scaled_judged(reference, 1.0, judged);
  const FlipExposures masked = *flip_exposures(zeroed, judged),
                      alone = *flip_exposures(strip_and_lamp(36, false));
  EXPECT_EQ(masked.start, alone.start);
  EXPECT_EQ(masked.stop, alone.stop);
  EXPECT_EQ(masked.count, alone.count);
  EXPECT_NE(flip_exposures(zeroed)->stop, alone.stop);
  EXPECT_FALSE(flip_exposures(zeroed, Image<std::uint8_t>(96, 96)).has_value());
}

TEST(PerceptualMetrics, PixelsWithoutAReferenceLeaveTheOthersErrors) {
  RgbImage reference = strip_and_lamp(96, false);
  for (Plane& plane : reference)
    std::fill(plane.pixels().begin() + 36 * 96, plane.pixels().end(), std::nan(""));
  MetricOptions options;
  options.perceptual = Perceptual::kAll;
  const MetricTable holed = error_metrics(strip_and_lamp(96, true), {reference, {}, {}}, options);
  const MetricTable alone =
      error_metrics(strip_and_lamp(36, true), {strip_and_lamp(36, false), {}, {}}, options);
  for (const char* name : {"ssim", "flip_ldr", "flip_hdr", "psnr_tm", "relmse"})
    EXPECT_NEAR(holed[name].value, alone[name].value, 1e-3 + 0.05 * std::abs(alone[name].value))
        << name;
}

TEST(Ssim, MapsEqualTheTwin) {
  for (const auto& [width, height] : {std::pair{31, 17}, {11, 11}, {9, 30}, {1, 1}, {6, 4}}) {
    const Plane a = uniform_image(width, height, 5)[0], b = uniform_image(width, height, 6)[0];
    const int size = ssim_window(width, height);
    const SimilarityMaps maps = ssim_maps(a, b);
    int inside = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int r = size / 2;
        if (x < r || y < r || x + r >= width || y + r >= height) {
          EXPECT_TRUE(std::isnan(maps.ssim(x, y)));
          continue;
        }
        ++inside;
        const reference::WindowSimilarity slow = reference::similarity_at(a, b, size, x, y);
        EXPECT_NEAR(maps.ssim(x, y), slow.ssim, 1e-11);
        EXPECT_NEAR(maps.contrast_structure(x, y), slow.contrast_structure, 1e-11);
      }
    }
    EXPECT_GT(inside, 0);
  }
}

TEST(MsSsim, EqualsTheTwinAtEveryNumberOfScales) {
  for (const auto& [side, scales] : {std::pair{21, 1}, {22, 2}, {50, 3}, {88, 4}, {177, 5}}) {
    const Plane a = luma(uniform_image(side + 4, side, 5)),
                b = luma(uniform_image(side + 4, side, 6));
    Plane mixed(side + 4, side);
    for (std::size_t p = 0; p < mixed.size(); ++p)
      mixed[p] = 0.7 * a[p] + 0.3 * b[p];
    ASSERT_EQ(ms_ssim_scales(side + 4, side), scales);
    std::vector<double> means;
    const auto maps = ms_ssim_maps(a, mixed);
    for (std::size_t j = 0; j < maps.size(); ++j)
      means.push_back(mean_of(j + 1 < maps.size() ? maps[j].contrast_structure : maps[j].ssim));
    EXPECT_NEAR(ms_ssim_value(means, ms_ssim_weights(scales)), reference::ms_ssim(a, mixed, scales),
                1e-10);
  }
}

TEST(MsSsim, NegativeMeansCountAsZero) {
  EXPECT_EQ(ms_ssim_value({-0.1, 0.5}, {0.5, 0.5}), 0.0);
  EXPECT_TRUE(std::isnan(ms_ssim_value({0.5, std::nan("")}, {0.5, 0.5})));
}

TEST(PerceptualMetrics, AreInTheTableAndPerfectForEqualImages) {
  const RgbImage image = uniform_image(60, 40, 3);
  MetricOptions options;
  options.perceptual = Perceptual::kAll;
  const MetricTable table = error_metrics(image, {image, {}, {}}, options);
  EXPECT_NEAR(table["ssim"].value, 1.0, 1e-12);
  EXPECT_NEAR(table["ms_ssim"].value, 1.0, 1e-12);
  EXPECT_EQ(table["flip_ldr"].value, 0.0);
  EXPECT_EQ(table["flip_hdr"].value, 0.0);
  EXPECT_EQ(table.guards[Guard::kSmallImage], 1u);
}

TEST(PerceptualMetrics, AreComputedOnlyWhenAskedFor) {
  const RgbImage r = uniform_image(60, 40, 3), i = test::add_noise(r, 4, 0.1);
  MetricOptions options;
  EXPECT_TRUE(std::isnan(error_metrics(i, {r, {}, {}}, options)["flip_hdr"].value));
  EXPECT_GT(error_metrics(i, {r, {}, {}}, options)["flip_ldr"].standard_error, 0.0);
  options.perceptual = Perceptual::kNone;
  EXPECT_TRUE(std::isnan(error_metrics(i, {r, {}, {}}, options)["ssim"].value));
}

TEST(PerceptualMetrics, PixelsThatAreNotFiniteDoNotSpread) {
  const RgbImage r = uniform_image(60, 40, 3);
  RgbImage i = test::add_noise(r, 4, 0.1);
  const MetricTable whole = error_metrics(i, {r, {}, {}});
  i[1](30, 20) = std::nan("");
  const MetricTable holed = error_metrics(i, {r, {}, {}});
  for (const char* name : {"ssim", "ms_ssim", "flip_ldr"}) {
    EXPECT_NEAR(holed[name].value, whole[name].value, 0.05) << name;
    EXPECT_NE(holed[name].value, whole[name].value) << name;
  }
}

}  // namespace
}  // namespace spool
