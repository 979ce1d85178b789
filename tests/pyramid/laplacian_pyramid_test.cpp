#include "lib/pyramid/laplacian_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/pyramid/convolution.h"
#include "tests/pyramid/pyramid_cases.h"
#include "tests/reference/laplacian_pyramid_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::max_abs;
using reference::max_difference;
using reference::noise_image;

constexpr WaveletFilter kFilters[] = {WaveletFilter::kHaar, WaveletFilter::k53, WaveletFilter::k97,
                                      WaveletFilter::kDb3};

// out(x, y) = in(x + dx, y + dy), periodic
Plane shifted(const Plane& in, int dx, int dy) {
  Plane out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      out(x, y) = in(extend(x + dx, in.width(), Extension::kPeriodic),
                     extend(y + dy, in.height(), Extension::kPeriodic));
    }
  }
  return out;
}

Plane decimated(const Plane& in) {
  Plane out(in.width() / 2, in.height() / 2);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x)
      out(x, y) = in(2 * x, 2 * y);
  }
  return out;
}

TEST(LaplacianPyramid, CollapseOfBuildIsIdentityForEveryOptionSizeAndBorder) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {7, 1}, {2, 3}, {13, 9}, {97, 61}}) {
    const Plane image = reference::firefly_image(width, height, 3);
    for (const Extension extension : kExtensions) {
      for (const PyramidOptions& options : all_pyramid_options(extension)) {
        const Pyramid pyramid = build_pyramid(image, options);
        EXPECT_LE(max_difference(collapse(pyramid, options), image), 2e-14 * max_abs(image))
            << describe(options) << " " << width << "x" << height;
      }
    }
  }
}

TEST(LaplacianPyramid, CorrectedEquationsOneToThreeAreTheConvolutionBitForBit) {
  const Plane image = noise_image(37, 22, 5);
  for (const WaveletFilter filter : kFilters) {
    const Taps h = filter_pair(filter).analysis;
    for (const Extension extension : kExtensions) {
      for (const int dilation : {1, 2, 4}) {
        EXPECT_EQ(reference::eqs_1_to_3(image, h, dilation, 1, extension),
                  convolve(image, h, dilation, extension));
      }
    }
  }
}

// As printed, eq 1 makes odd columns and rows the convolution two pixels further left and up.
TEST(LaplacianPyramid, LiteralEquationOneIsTwoPixelsOffOnOddColumns) {
  const Plane image = noise_image(32, 32, 6);
  const Taps h = filter_pair(WaveletFilter::k53).analysis;
  const Plane literal = reference::eqs_1_to_3(image, h, 1, -1, Extension::kPeriodic);
  const Plane right = convolve(image, h, 1, Extension::kPeriodic);
  double error = 0.0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const int from_x = extend(x - 2 * (x % 2), 32, Extension::kPeriodic);
      const int from_y = extend(y - 2 * (y % 2), 32, Extension::kPeriodic);
      EXPECT_EQ(literal(x, y), right(from_x, from_y));
      error = std::max(error, std::abs(literal(x, y) - right(x, y)));
    }
  }
  EXPECT_GT(error, 0.5 * max_abs(right));
}

// K decimated levels of every one of the 4^K shifts, interleaved, are the a-trous image to the bit.
TEST(LaplacianPyramid, CycleSpunDecimatedPyramidIsAtrous) {
  const int levels = 3, step = 1 << levels;
  const Plane image = noise_image(32, 24, 7);
  for (const WaveletFilter filter : kFilters) {
    {
      PyramidOptions options;
      options.filter = filter;
      options.levels = levels;
      options.extension = Extension::kPeriodic;
      const Plane atrous = build_pyramid(image, options).coarse.back();
      for (int j = 0; j < step; ++j) {
        for (int i = 0; i < step; ++i) {
          Plane coarse = shifted(image, i, j);
          for (int k = 0; k < levels; ++k) {
            const Taps h = filter_pair_at(filter, options.roles, k).analysis;
            coarse = decimated(convolve(coarse, h, 1, Extension::kPeriodic));
          }
          for (int y = 0; y < coarse.height(); ++y) {
            for (int x = 0; x < coarse.width(); ++x) {
              ASSERT_EQ(coarse(x, y), atrous(step * x + i, step * y + j));
            }
          }
        }
      }
    }
  }
}

TEST(LaplacianPyramid, CycleSpunDetailIsTheMeanOfTheFourPhases) {
  const Plane image = noise_image(32, 32, 8);
  for (const WaveletFilter filter : kFilters) {
    PyramidOptions options;
    options.filter = filter;
    options.levels = 1;
    options.extension = Extension::kPeriodic;
    const Plane spun = build_pyramid(image, options).detail[0];
    options.detail = LaplacianDetail::kPhase00;
    Plane mean(32, 32);
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const Plane one = shifted(build_pyramid(shifted(image, i, j), options).detail[0], -i, -j);
        for (std::size_t p = 0; p < mean.size(); ++p)
          mean[p] += one[p] / 4.0;
      }
    }
    EXPECT_LE(max_difference(spun, mean), 1e-14);
  }
}

TEST(LaplacianPyramid, CycleSpunIsShiftInvariantAndPhase00IsNot) {
  const Plane image = noise_image(64, 64, 9);
  for (const auto detail : {LaplacianDetail::kCycleSpun, LaplacianDetail::kPhase00}) {
    PyramidOptions options;
    options.detail = detail;
    options.levels = 3;
    options.extension = Extension::kPeriodic;
    const Pyramid still = build_pyramid(image, options);
    const Pyramid moved = build_pyramid(shifted(image, 1, 1), options);
    for (std::size_t k = 0; k < 3; ++k) {
      const double change = max_difference(shifted(still.detail[k], 1, 1), moved.detail[k]);
      if (detail == LaplacianDetail::kCycleSpun) {
        EXPECT_EQ(change, 0.0);
      } else {
        EXPECT_GT(change, 0.1 * max_abs(still.detail[k]));
      }
    }
  }
}

TEST(LaplacianPyramid, ConstantImageHasNoDetail) {
  for (const Extension extension : kExtensions) {
    for (const PyramidOptions& options : all_pyramid_options(extension)) {
      if (options.detail == LaplacianDetail::kPhase00) continue;  // zero insertion meets the border
      const Pyramid pyramid = build_pyramid(Plane(29, 17, 5e3), options);
      for (const Plane& detail : pyramid.detail) {
        EXPECT_LE(max_abs(detail), 2e-15 * 5e3) << describe(options);
      }
    }
  }
}

// The kernel (g/2) * h has DC gain 1; it is symmetric, so a ramp passes unchanged.
TEST(LaplacianPyramid, RampHasNoDetailInside) {
  Plane ramp(128, 128);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x)
      ramp(x, y) = 3.0 * x - 2.0 * y + 1.0;
  }
  for (const WaveletFilter filter : kFilters) {
    PyramidOptions options;
    options.filter = filter;
    options.levels = 3;
    const Pyramid pyramid = build_pyramid(ramp, options);
    for (std::size_t k = 0; k < 3; ++k) {
      for (int y = 56; y < 72; ++y) {
        for (int x = 56; x < 72; ++x)
          EXPECT_NEAR(pyramid.detail[k](x, y), 0.0, 1e-11);
      }
    }
  }
}

// White-noise power gain of f_4 (sum of squares of its kernel), against a 16 x 16 box (1/256).
TEST(LaplacianPyramid, NoiseGainOfTheFourthLevel) {
  Plane delta(256, 256);
  delta(128, 128) = 1.0;
  for (const auto& [filter, expected, tolerance] : {std::tuple{WaveletFilter::kHaar, 1.00, 1e-12},
                                                    {WaveletFilter::kDb3, 1.00, 0.005},
                                                    {WaveletFilter::k97, 0.93, 0.005},
                                                    {WaveletFilter::k53, 4.07, 0.005}}) {
    PyramidOptions options;
    options.filter = filter;
    options.extension = Extension::kPeriodic;
    const Plane kernel = build_pyramid(delta, options).coarse[4];
    double gain = 0.0;
    for (const double value : kernel.pixels())
      gain += value * value;
    EXPECT_NEAR(gain * 256.0, expected, tolerance);
  }
}

Rectangle box_of_difference(const Plane& a, const Plane& b) {
  Rectangle box{1 << 30, 1 << 30, 0, 0};
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (a(x, y) == b(x, y)) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
             std::max(box.y1, y + 1)};
    }
  }
  return box;
}

Plane with_box_changed(const Plane& image, const Rectangle& box, std::uint64_t seed) {
  Plane result = image;
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x)
      result(x, y) += 1.0 + unit_double(mix(seed, x, y));
  }
  return result;
}

// Reach of d per level 1..4 on either side.
TEST(LaplacianPyramid, RegionOfInfluenceIsTight) {
  const Rectangle changed{90, 85, 94, 89}, bounds{0, 0, 192, 192};
  const Plane before = noise_image(192, 192, 10);
  const Plane after = with_box_changed(before, changed, 11);
  struct Case {
    WaveletFilter filter;
    int left[4], right[4];
  };
  for (const Case& one : {Case{WaveletFilter::k53, {3, 8, 18, 38}, {3, 8, 18, 38}},
                          Case{WaveletFilter::k97, {7, 18, 40, 84}, {7, 18, 40, 84}},
                          Case{WaveletFilter::kHaar, {1, 2, 6, 10}, {1, 3, 5, 13}},
                          Case{WaveletFilter::kDb3, {5, 11, 29, 53}, {5, 14, 26, 62}}}) {
    PyramidOptions options;
    options.filter = one.filter;
    const Pyramid a = build_pyramid(before, options), b = build_pyramid(after, options);
    std::vector<Rectangle> coarse, detail;
    pyramid_influence(changed, bounds, options, coarse, detail);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(detail[k],
                grow(changed, one.left[k], one.right[k], one.left[k], one.right[k], bounds));
      EXPECT_EQ(box_of_difference(a.coarse[k], b.coarse[k]), coarse[k]);
      EXPECT_EQ(box_of_difference(a.detail[k], b.detail[k]), detail[k]) << k << describe(options);
    }
  }
}

TEST(LaplacianPyramid, LocalUpdateHasTheBitsOfAFullRebuild) {
  const Plane before = reference::firefly_image(61, 47, 12);
  for (const Rectangle& changed :
       {Rectangle{0, 0, 1, 1}, Rectangle{7, 8, 8, 9}, Rectangle{30, 20, 34, 24},
        Rectangle{55, 40, 61, 47}, Rectangle{0, 30, 61, 31}}) {
    const Plane after = with_box_changed(before, changed, 13);
    for (const Extension extension : kExtensions) {
      for (const PyramidOptions& options : all_pyramid_options(extension)) {
        Pyramid local = build_pyramid(before, options);
        local.coarse[0] = after;
        update_pyramid(local, changed, options);
        const Pyramid full = build_pyramid(after, options);
        ASSERT_EQ(local.coarse, full.coarse) << describe(options);
        ASSERT_EQ(local.detail, full.detail) << describe(options);
      }
    }
  }
}

TEST(LaplacianPyramid, UpdateTouchesTheBoxesOfItsInfluenceAlone) {
  PyramidOptions options;
  const Plane image = noise_image(50, 40, 1);
  const Rectangle changed{10, 11, 12, 13};
  std::vector<Rectangle> coarse, detail;
  pyramid_influence(changed, image.bounds(), options, coarse, detail);
  // Another pyramid's images show where they were written over.
  Pyramid pyramid = build_pyramid(noise_image(50, 40, 2), options);
  const Pyramid before = pyramid;
  pyramid.coarse[0] = image;
  update_pyramid(pyramid, changed, options);
  ASSERT_EQ(coarse.size(), 5u);
  ASSERT_EQ(detail.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(box_of_difference(pyramid.coarse[k + 1], before.coarse[k + 1]), coarse[k + 1]) << k;
    EXPECT_EQ(box_of_difference(pyramid.detail[k], before.detail[k]), detail[k]) << k;
  }
  EXPECT_EQ(coarse[0], changed);
  EXPECT_EQ(coarse[1], (Rectangle{8, 9, 14, 15}));
}

TEST(LaplacianPyramid, RebuildReusesStorageOfAnySizeAndTakesItsOwnFirstImage) {
  PyramidOptions options;
  Pyramid pyramid = build_pyramid(noise_image(9, 9, 1), options);
  const Plane image = noise_image(31, 20, 2);
  rebuild_pyramid(pyramid, image, options);
  const Pyramid fresh = build_pyramid(image, options);
  EXPECT_EQ(pyramid.detail, fresh.detail);
  const double* storage = pyramid.detail[2].pixels().data();
  rebuild_pyramid(pyramid, pyramid.coarse[0], options);
  EXPECT_EQ(pyramid.coarse, fresh.coarse);
  EXPECT_EQ(pyramid.detail, fresh.detail);
  EXPECT_EQ(pyramid.detail[2].pixels().data(), storage);
}

}  // namespace
}  // namespace spool
