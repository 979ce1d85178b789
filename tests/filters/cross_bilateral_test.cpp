// The feature-guided filter against its slow twin, and its laws.
#include "lib/filters/cross_bilateral.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/kernels/piece_estimates.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/cross_bilateral_reference.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::select_counts;
using testing::select_uniform;

void agrees_with_the_twin(int width, int height, const CrossBilateralOptions& options,
                          const testing::FeatureFunction& feature = {}) {
  const SamplePool pool =
      make_pool(width, height, 8, noisy_picture(width, height, 7), {}, {}, feature);
  const Selection selection = select_counts(pool, [](int x, int y) { return 4 + (3 * x + y) % 5; });
  const PieceStatistics& statistics = selection.statistics;
  GuardCounts guards;
  const auto result = cross_bilateral(statistics, pool, 1.0, options, guards, RisksKept::kAll);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  const auto pieces = estimate_pieces(statistics, {}, 1.0, guards);
  const auto twin = reference::cross_bilateral(pieces->mean, pieces->variance,
                                               reference::features(pool, statistics.n), options);
  for (std::size_t i = 0; i < result->scale.size(); ++i) {
    const auto chosen = static_cast<std::size_t>(result->scale[i]);
    double least = INFINITY;
    for (std::size_t s = 0; s < options.scales.size(); ++s) {
      ASSERT_NEAR(result->all[s][i], twin.risk[s][i], 2e-6) << width << "x" << height << " " << s;
      least = std::min(least, twin.risk[s][i]);
    }
    ASSERT_NEAR(twin.risk[chosen][i], least, 4e-6);  // weights are float
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(result->image[c][i], twin.filtered[chosen][c][i], 2e-6);
  }
}

TEST(CrossBilateralDifferential, AgreesWithTheSlowTwin) {
  CrossBilateralOptions options;
  options.scales = {0, 1, 2};
  options.risk_scale = 1.5;
  for (int size = 1; size <= 17; ++size)
    agrees_with_the_twin(size, 18 - size, options);
  agrees_with_the_twin(31, 9, options);
  agrees_with_the_twin(64, 5, options);
  agrees_with_the_twin(12, 9, {});  // windows larger than the image
  options.scales = {0.6, 3};        // without the input itself
  agrees_with_the_twin(11, 14, options);
}

// Variances of features above the floor, and not the same in every pixel.
TEST(CrossBilateralDifferential, AgreesWithTheSlowTwinWhereFeaturesAreNoisy) {
  CrossBilateralOptions options;
  options.scales = {0, 1, 2};
  options.risk_scale = 1.5;
  const auto noisy = [](std::string_view layer, std::size_t c, int x, int y, int s) {
    return 0.2 * (x % 5) + (1.0 + x % 3 + y) * unit_double(mix(layer.size(), c, x, y, s));
  };
  agrees_with_the_twin(13, 11, options, noisy);
  agrees_with_the_twin(37, 9, options, noisy);
  agrees_with_the_twin(7, 68, options, noisy);  // more than one tile
  agrees_with_the_twin(133, 3, options, noisy);
}

TEST(CrossBilateral, AConstantImageStaysWhateverTheFeatures) {
  const SamplePool pool =
      make_pool(17, 12, 4, [](int, int, int) { return Rgb{0.5f, 0.25f, 2.0f}; });
  const auto result = reconstruct_cross_bilateral(select_uniform(pool, 4), pool, {}, {});
  ASSERT_TRUE(result.has_value());
  for (const double v : result->image[2].pixels())
    EXPECT_NEAR(v, 2.0, 1e-12);
}

TEST(CrossBilateral, WithTheInputAloneReturnsIt) {
  const SamplePool pool = make_pool(13, 9, 6, noisy_picture(13, 9, 5));
  CrossBilateralOptions options;
  options.scales = {0};
  const Selection selection = select_uniform(pool, 5);
  EXPECT_EQ(reconstruct_cross_bilateral(selection, pool, options, {})->image,
            selection.statistics.mean);
}

TEST(CrossBilateral, KeepsAnEdgeThatTheAlbedoShowsAndSmoothsBesideIt) {
  // Features without noise or slope: those of make_pool tell neighbours apart everywhere.
  const int width = 24, height = 16;
  RecordedSamples recording = make_pool(width, height, 8, [=](int x, int y, int s) {
                                const auto noise =
                                    static_cast<float>(unit_double(mix(6, x, y, s)) - 0.5);
                                const float value = (2 * x < width ? 1.0f : 4.0f) + noise;
                                return Rgb{value, value, value};
                              }).recording();
  test::add_features(recording, [=](std::string_view layer, std::size_t, int x, int, int) {
    return layer == "albedo" && 2 * x < width ? 0.2 : 0.7;
  });
  const SamplePool pool =
      *SamplePool::create(std::make_shared<const RecordedSamples>(std::move(recording)), {});
  const Selection selection = select_uniform(pool, 8);
  const auto result = reconstruct_cross_bilateral(selection, pool, {}, {});
  double raw = 0.0, smooth = 0.0, left = 0.0, right = 0.0;
  for (int y = 0; y < height; ++y) {
    // Without the albedo a third of a unit would leak; the noise of a pixel is 0.1.
    EXPECT_NEAR(result->image[0](11, y), 1.0, 0.2);
    EXPECT_NEAR(result->image[0](12, y), 4.0, 0.2);
    left += result->image[0](11, y) / height;
    right += result->image[0](12, y) / height;
    for (int x = 0; x < 12; ++x) {
      raw += std::pow(selection.statistics.mean[0](x, y) - 1.0, 2);
      smooth += std::pow(result->image[0](x, y) - 1.0, 2);
    }
  }
  EXPECT_NEAR(left, 1.0, 0.04);
  EXPECT_NEAR(right, 4.0, 0.04);
  EXPECT_LT(smooth, 0.2 * raw);
}

TEST(CrossBilateral, IsRefusedWithoutFeatures) {
  auto recording = RecordedSamples::from_memory("plain", 2, 2, 2, std::vector<float>(24, 1.0f));
  const auto pool = SamplePool::create(
      std::make_shared<const RecordedSamples>(std::move(*recording)), PoolOptions{});
  const auto result = reconstruct_cross_bilateral(select_uniform(*pool, 2), *pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_NE(result.error().message.find("albedo, normal or depth"), std::string::npos);
}

TEST(FeatureStatistics, FollowTheOrderOfThePoolAndCountWhatIsNotFinite) {
  auto recording = RecordedSamples::from_memory("plain", 3, 2, 4, std::vector<float>(72, 1.0f));
  recording->set_features({{"depth", "Z"}},
                          [](const FeatureLayer&, const Rectangle& box, int samples) {
                            std::vector<float> values;
                            for (long long i = 0; i < box.area() * samples; ++i)
                              values.push_back(i == 5 ? INFINITY : static_cast<float>(i));
                            return Result<std::vector<float>>(values);
                          });
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  options.seed = 9;
  const auto pool =
      SamplePool::create(std::make_shared<const RecordedSamples>(std::move(*recording)), options);
  CountImage n(3, 2, 2);
  n(1, 0) = 4;
  n(2, 1) = 1;
  GuardCounts guards;
  const auto features = feature_statistics(*pool, n, guards);
  ASSERT_TRUE(features.has_value());
  const auto raw = [&](int x, int y, int i) {
    return 4.0 * (3 * y + x) + pool->recorded_index(x, y, i);
  };
  const double largest = raw(2, 1, 0);
  EXPECT_NEAR((*features)[0].mean[0](0, 1), (raw(0, 1, 0) + raw(0, 1, 1)) / 2 / largest, 1e-14);
  EXPECT_NEAR((*features)[0].mean[0](1, 0), (4 + 0 + 6 + 7) / 4.0 / largest, 1e-14);
  EXPECT_EQ(guards[Guard::kFeatureNotFinite], 1u);
}

}  // namespace
}  // namespace spool
