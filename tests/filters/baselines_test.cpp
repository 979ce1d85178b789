// Laws of the filters that the directional one is compared with.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "lib/filters/given_image.h"
#include "lib/filters/greedy_selection.h"
#include "lib/filters/multistage.h"
#include "lib/filters/nl_means.h"
#include "lib/filters/oracle_scale.h"
#include "lib/filters/wavelet_shrinkage.h"
#include "lib/kernels/scale_ladder.h"
#include "lib/kernels/truncated_filter.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::random_film;
using testing::select_counts;
using testing::select_uniform;

double error_against(const RgbImage& image, const RgbImage& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image[0].size(); ++i)
    sum += std::pow(image[0][i] - truth[0][i], 2);
  return sum;
}

// The picture of testing::noisy_picture without its noise.
RgbImage clean_picture(int width, int height, std::uint64_t key) {
  const SamplePool many = make_pool(width, height, 512, noisy_picture(width, height, key));
  RgbImage mean = make_rgb(width, height);
  for (std::size_t c = 0; c < 3; ++c)
    mean[c] = select_uniform(many, 512).statistics.mean[c];
  return mean;
}

TEST(Baselines, AllFiltersBeatTheBoxOnANoisyPicture) {
  const int size = 48;
  const SamplePool pool = make_pool(size, size, 8, noisy_picture(size, size, 3));
  const Selection selection = select_uniform(pool, 4);
  const RgbImage truth = clean_picture(size, size, 99);
  const Reference reference{truth, std::nullopt};
  FilterContext context;
  context.reference = &reference;
  const auto box = (*make_method(filters(), {"box", "", {}}))(selection, pool, context);
  for (const char* name :
       {"greedy_selection", "nl_means", "wavelet_shrinkage", "oracle_scale", "directional"}) {
    const auto result = (*make_method(filters(), {name, "", {}}))(selection, pool, context);
    ASSERT_TRUE(result.has_value()) << name;
    EXPECT_LT(error_against(result->image, truth), 0.6 * error_against(box->image, truth)) << name;
  }
}

TEST(Baselines, ConstantsArePreserved) {
  const SamplePool pool = make_pool(
      21, 18, 6, [](int, int, int) { return Rgb{0.1f, 0.7f, 1234.5f}; }, {}, random_film(6));
  const Selection selection = select_counts(pool, [](int x, int y) { return 1 + (x + y) % 6; });
  for (const char* name : {"greedy_selection", "nl_means", "wavelet_shrinkage", "multistage"}) {
    const auto result = (*make_method(filters(), {name, "", {}}))(selection, pool, FilterContext{});
    ASSERT_TRUE(result.has_value()) << name;
    // The taps of the 9-7 filters are known to 15 digits.
    for (const double v : result->image[1].pixels())
      ASSERT_NEAR(v / static_cast<double>(0.7f), 1.0, 1e-13) << name;
    for (const double v : result->image[2].pixels())
      ASSERT_NEAR(v / 1234.5, 1.0, 1e-13) << name;
  }
}

TEST(Baselines, ExposureByAPowerOfTwoScalesExactly) {
  const auto picture = noisy_picture(29, 22, 6);
  const SamplePool pool = make_pool(29, 22, 4, picture, {}, random_film(4));
  const SamplePool scaled = make_pool(
      29, 22, 4,
      [&](int x, int y, int s) {
        Rgb value = picture(x, y, s);
        for (float& v : value)
          v *= 0x1p-10f;
        return value;
      },
      {}, random_film(4));
  for (const char* name : {"greedy_selection", "nl_means", "wavelet_shrinkage", "multistage"}) {
    const auto make = make_method(filters(), {name, "", {}});
    const auto a = (*make)(select_uniform(pool, 4), pool, FilterContext{});
    const auto b = (*make)(select_uniform(scaled, 4), scaled, FilterContext{});
    for (std::size_t i = 0; i < a->image[0].size(); ++i)
      ASSERT_EQ(a->image[0][i] * 0x1p-10, b->image[0][i]) << name;
  }
}

TEST(GreedySelection, FlatNoiseTakesTheLargestScale) {
  const SamplePool pool = make_pool(40, 40, 8, [](int x, int y, int s) {
    const auto v = static_cast<float>(unit_double(mix(4, x, y, s)));
    return Rgb{v, v, v};
  });
  const auto result = reconstruct_greedy_selection(select_uniform(pool, 8), pool, {}, {});
  int largest = 0;
  for (const int k : result->level->pixels())
    largest += k == 8 ? 1 : 0;
  EXPECT_GT(largest, 1200);
}

TEST(WaveletShrinkage, LambdaZeroReturnsTheInput) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {33, 20}, {64, 48}}) {
    const SamplePool pool = make_pool(width, height, 4, noisy_picture(width, height, 5));
    const Selection selection = select_uniform(pool, 4);
    WaveletShrinkageOptions options;
    options.lambda = 0.0;
    const auto result = reconstruct_wavelet_shrinkage(selection, pool, options, {});
    EXPECT_LT(reference::max_difference(result->image[0], selection.statistics.mean[0]), 1e-12);
  }
}

TEST(WaveletTransform, NoBasisFunctionOfAConstantButTheCoarsest) {
  Plane image(32, 32, 3.0);
  forward_transform(image, 3, TransformOf::kValues);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x)
      EXPECT_NEAR(image(x, y), x < 4 && y < 4 ? 24.0 : 0.0, 1e-13);
  }
}

TEST(Multistage, WithoutPositionsItIsTheBoxFilterAndSaysSo) {
  const SamplePool pool = make_pool(7, 6, 4, noisy_picture(7, 6, 6));
  const auto result = reconstruct_multistage(select_uniform(pool, 4), pool, {}, {});
  EXPECT_EQ(result->image[0], select_uniform(pool, 4).statistics.mean[0]);
  ASSERT_EQ(result->notes.size(), 1u);
}

TEST(Multistage, ADenseClusterDoesNotOutweighItsNeighbours) {
  // Many bright samples in one cell, one dark sample in each other cell that has any.
  std::vector<FilmPosition> film(12, FilmPosition{0.1f, 0.1f});
  film[0] = {0.6f, 0.6f};
  const SamplePool pool = make_pool(
      9, 9, 12, [](int, int, int s) { return s == 0 ? Rgb{0, 0, 0} : Rgb{1, 1, 1}; }, {}, film);
  const auto result = reconstruct_multistage(select_uniform(pool, 12), pool, {}, {});
  EXPECT_NEAR(result->image[0](4, 4), 0.5, 0.05);  // the mean would be 11 / 12
}

TEST(OracleScale, IsNeverWorseThanTheBoxWhenEveryPixelChooses) {
  const int size = 32;
  const SamplePool pool = make_pool(size, size, 4, noisy_picture(size, size, 3));
  const Reference reference{clean_picture(size, size, 98), std::nullopt};
  FilterContext context;
  context.reference = &reference;
  OracleScaleOptions options;
  options.error_smoothing = 0.0;
  const Selection selection = select_uniform(pool, 4);
  const auto result = reconstruct_oracle_scale(selection, pool, options, context);
  for (int i = 0; i < size * size; ++i) {
    double mine = 0.0, box = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = static_cast<std::size_t>(i);
      mine += std::pow(result->image[c][at] - reference.mean[c][at], 2);
      box += std::pow(selection.statistics.mean[c][at] - reference.mean[c][at], 2);
    }
    EXPECT_LE(mine, box + 1e-15);
  }
}

TEST(OracleScale, WithoutAReferenceIsAnError) {
  const SamplePool pool = make_pool(4, 4, 4, noisy_picture(4, 4, 3));
  const auto result = reconstruct_oracle_scale(select_uniform(pool, 4), pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find("4 x 4"), std::string::npos);
}

TEST(GivenImage, ComesBackForItsSizeAndIsRefusedForAnother) {
  const SamplePool pool = make_pool(4, 3, 4, noisy_picture(4, 3, 3));
  const RgbImage image = make_rgb(4, 3, 0.25);
  const auto same = given_image(image, "a.exr")(select_uniform(pool, 1), pool, {});
  ASSERT_TRUE(same.has_value());
  EXPECT_EQ(same->image, image);
  const auto other = given_image(make_rgb(3, 3), "a.exr")(select_uniform(pool, 1), pool, {});
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().message,
            "a.exr: 3 x 3 pixels, the recording has 4 x 3: give an image of the same size");
}

TEST(TruncatedFilter, AConstantStaysAndItsVarianceFallsWithTheWindow) {
  const Taps taps = floor_gaussian_taps(2.0);
  const Plane mean = truncated_mean(Plane(20, 9, 3.0), taps);
  for (const double v : mean.pixels())
    EXPECT_NEAR(v, 3.0, 1e-14);
  const Plane variance = truncated_variance(Plane(20, 20, 1.0), taps, squared_taps(taps));
  EXPECT_NEAR(variance(10, 10), 1.0 / (4 * M_PI * 4.0), 1e-3);
  EXPECT_GT(variance(0, 0), 2.0 * variance(10, 10));
}

// A single sample under the kernel must not make every change look like noise.
TEST(ScaleLadder, AnEnormousChangeStopsEvenWithASingleSample) {
  const auto balance = [](double step) {
    Plane sum(1, 1);
    add_transition({Plane(1, 1), Plane(1, 1, 1.0)}, {Plane(1, 1, step), Plane(1, 1)},
                   Plane(1, 1, 1.0), 1.0, transition_caution(0.2), sum, nullptr);
    return sum(0, 0);
  };
  EXPECT_GT(balance(1e6), 0.0);
  EXPECT_LT(balance(1e-3), 0.0);
}

}  // namespace
}  // namespace spool
