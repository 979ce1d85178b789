// Patches against whole images: the same bits, wherever a patch lies.
#include "lib/pyramid/patch.h"

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/region_mean.h"

namespace spool {
namespace {

Image<float> noise(int width, int height) {
  Image<float> image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image(x, y) = static_cast<float>(unit_double(mix(8, x, y)) - 0.3);
  }
  return image;
}

const Rectangle kBoxes[] = {{0, 0, 5, 7}, {3, 9, 20, 11}, {17, 0, 23, 29}, {0, 0, 23, 29}};

// Two convolutions in a row on patches are those of the whole image, borders and all.
TEST(Patch, ConvolutionsAreThoseOfTheWholeImage) {
  const Image<float> image = noise(23, 29);
  for (const auto filter :
       {WaveletFilter::kHaar, WaveletFilter::k53, WaveletFilter::k97, WaveletFilter::kDb3}) {
    const Taps taps = filter_pair(filter).analysis;
    const int reach = std::max(taps.last(), -taps.first);
    for (const Extension rule : {Extension::kSymmetric, Extension::kClamp, Extension::kWhole}) {
      const Image<float> once = convolve(image, taps, 1, rule);
      const Image<float> twice = convolve(once, taps, 2, rule);
      for (const Rectangle& box : kBoxes) {
        const Patch<float> fine = extended_patch(image, rule, grown(box, 3 * reach));
        Patch<float> coarse(grown(box, 2 * reach)), result(box);
        convolve_patch(fine, taps, 1, intersect(coarse.extent(), image.bounds()), coarse);
        extend_patch(coarse, image.bounds(), rule);
        convolve_patch(coarse, taps, 2, box, result);
        for (int y = box.y0; y < box.y1; ++y) {
          for (int x = box.x0; x < box.x1; ++x) {
            ASSERT_EQ(*coarse.at(x, y), once(x, y)) << x << " " << y;
            ASSERT_EQ(*result.at(x, y), twice(x, y)) << x << " " << y;
          }
        }
      }
    }
  }
}

TEST(Patch, DoublingUpGivesTheSumsOverRegions) {
  const Image<float> image = noise(23, 29);
  Image<std::int32_t> counts(23, 29);
  Plane in_double(23, 29);
  for (std::size_t i = 0; i < image.size(); ++i) {
    in_double[i] = image[i];
    counts[i] = static_cast<std::int32_t>(mix(4, i) % 9);
  }
  for (const Rectangle& box : kBoxes) {
    constexpr int kLevels = 5;
    const Rectangle around = grown(box, 1 << (kLevels - 1));
    auto sums = padded_patch<float, float>(image, image.bounds(), around);
    auto whole = padded_patch<std::int32_t, std::int32_t>(counts, counts.bounds(), around);
    for (int level = 1; level <= kLevels; ++level) {
      sums = double_up(sums, level);
      whole = double_up(whole, level);
      const Plane expected = region_sum(in_double, level);
      for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) {
          ASSERT_NEAR(*sums.at(x, y), expected(x, y), 1e-6 * (1 << (2 * level)));
          std::int32_t sum = 0;
          const Rectangle r = region(x, y, level, counts.bounds());
          for (int v = r.y0; v < r.y1; ++v) {
            for (int u = r.x0; u < r.x1; ++u)
              sum += counts(u, v);
          }
          ASSERT_EQ(*whole.at(x, y), sum);
        }
      }
    }
    EXPECT_EQ(sums.extent(), box);
  }
}

}  // namespace
}  // namespace spool
