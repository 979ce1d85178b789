#include "lib/kernels/cross_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/reference/cross_patches_reference.h"
#include "tests/reference/test_images.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

struct Case {
  FeatureGuide guide;
  RgbImage y, v, image;
};

Case make_case(int width, int height) {
  Case result{{width, height, {}}, make_rgb(width, height), {}, {}};
  result.v = result.image = result.y;
  FeatureGuide::Feature albedo;
  albedo.factor = 2.0f;
  albedo.variance = Image<float>(width, height, 0.3f);
  for (std::size_t c = 0; c < 3; ++c) {
    result.y[c] = reference::noise_image(width, height, 10 + c);
    result.v[c] = reference::noise_image(width, height, 20 + c);
    result.image[c] = reference::noise_image(width, height, 30 + c);
    const Plane feature = reference::noise_image(width, height, 40 + c);
    albedo.mean.emplace_back(width, height);
    for (std::size_t i = 0; i < feature.size(); ++i) {
      albedo.mean[c][i] = static_cast<float>(feature[i]);
      result.v[c][i] *= result.v[c][i];
    }
  }
  result.guide.features.push_back(std::move(albedo));
  return result;
}

CrossPatchOptions small_options() {
  CrossPatchOptions options;
  options.window = 3;
  options.patch = 1;
  options.sigmas = {0.4, 1.6};
  return options;
}

TEST(CrossPatches, AgreeWithTheSlowTwinAndItsDifferenceQuotients) {
  const CrossPatchOptions options = small_options();
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {5, 1}, {9, 7}, {19, 6}}) {
    const Case given = make_case(width, height);
    const auto risks = cross_patch_risks(given.guide, given.y, given.v, options);
    const auto feature_weight = [&](int px, int py, int qx, int qy) {
      double squared = 0.0;
      for (const Image<float>& mean : given.guide.features[0].mean)
        squared += std::pow(double{mean(px, py)} - double{mean(qx, qy)}, 2);
      return std::exp(-2.0 * squared / 0.6);
    };
    for (std::size_t s = 0; s < options.sigmas.size(); ++s) {
      const CountImage choice(width, height, static_cast<int>(s + 1));
      const RgbImage means = cross_patch_means(given.guide, given.y, given.image, choice, options);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(means[c](x, y),
                        reference::cross_patch_mean(given.y, given.image[c], feature_weight,
                                                    options.sigmas[s], options, x, y),
                        1e-5);
          }
          ASSERT_NEAR(risks[s](x, y),
                      reference::cross_patch_risk(given.y, given.v, feature_weight,
                                                  options.sigmas[s], options, x, y),
                      3e-5)
              << width << "x" << height << " at " << x << ", " << y;
        }
      }
    }
  }
}

TEST(CrossPatches, HaveTheSameBitsForAnyNumberOfThreads) {
  const Case given = make_case(37, 29);
  CountImage choice(37, 29);
  for (std::size_t i = 0; i < choice.size(); ++i)
    choice[i] = static_cast<std::int32_t>(i % 3);
  const auto risks = [&] {
    return cross_patch_risks(given.guide, given.y, given.v, small_options());
  };
  const auto means = [&] {
    return cross_patch_means(given.guide, given.y, given.image, choice, small_options());
  };
  const auto risks_of_one = test::with_threads(1, risks);
  const auto means_of_one = test::with_threads(1, means);
  EXPECT_EQ(means_of_one[1][3], given.image[1][3]);  // choice 0
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(test::with_threads(threads, risks), risks_of_one) << threads;
    EXPECT_EQ(test::with_threads(threads, means), means_of_one) << threads;
  }
}

// A tolerance below all distances leaves the image and the variance; one beyond all of them,
// without features, the mean of the window and what is left of the variance in it.
TEST(CrossPatches, EndAtTheImageAndAtTheMeanOfTheWindow) {
  Case given = make_case(11, 8);
  given.guide.features.clear();
  CrossPatchOptions options = small_options();
  options.sigmas = {1e-3, 1e3};
  const auto risks = cross_patch_risks(given.guide, given.y, given.v, options);
  const RgbImage narrow =
      cross_patch_means(given.guide, given.y, given.image, CountImage(11, 8, 1), options);
  const RgbImage wide =
      cross_patch_means(given.guide, given.y, given.image, CountImage(11, 8, 2), options);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 11; ++x) {
      double v = 0.0, mean = 0.0, count = 0.0;
      for (std::size_t c = 0; c < 3; ++c)
        v += given.v[c](x, y) / 3.0;
      for (int qy = std::max(0, y - 3); qy <= std::min(7, y + 3); ++qy) {
        for (int qx = std::max(0, x - 3); qx <= std::min(10, x + 3); ++qx, ++count)
          mean += given.image[1](qx, qy);
      }
      ASSERT_NEAR(narrow[1](x, y), given.image[1](x, y), 1e-6);
      ASSERT_NEAR(risks[0](x, y), v, 1e-6);
      ASSERT_NEAR(wide[1](x, y), mean / count, 1e-5);
    }
  }
}

}  // namespace
}  // namespace spool
