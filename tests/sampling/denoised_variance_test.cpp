// Sampling by denoised variances against its slow twin, and what denoising is worth.
#include "lib/sampling/denoised_variance.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/sampling/spending.h"
#include "tests/reference/stater_reference.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/every_method.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

TEST(DenoisedVariance, DeviationsAreThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const SamplePool pool = test::noisy_pool(width, height, 24);
    CountImage n(width, height);
    for (std::size_t i = 0; i < n.size(); ++i)
      n[i] = 4 + static_cast<int>(i % 7);
    PieceStatistics statistics = prefix_statistics(pool, n);
    GuardCounts guards;
    expose(statistics, pool, guards);
    reference::StaterCase at;
    at.unit = std::ldexp(1.0, std::ilogb(statistics.signal.exposure));
    at.features = *pair_features(pool, n, {}, guards);
    at.window = {20, 10.0};
    for (const bool denoised : {true, false}) {
      at.cascade = denoised;
      DenoisedVarianceOptions options;
      options.denoised = denoised;
      const auto deviation = sample_deviation(statistics, pool, options, guards);
      ASSERT_TRUE(deviation.has_value());
      const RgbImage expected = reference::stater_variances(pool, n, at);
      for (std::size_t i = 0; i < n.size(); ++i) {
        const double s = std::sqrt((expected[0][i] + expected[1][i] + expected[2][i]) / 3);
        ASSERT_NEAR((*deviation)[i], s, 1e-5 * (1 + s)) << denoised << " at " << i;
      }
    }
  }
}

// Two areas, one of twice the deviation: twice the samples.
TEST(DenoisedVariance, CountsAreInProportionToTheDeviation) {
  const SamplePool pool = test::memory_pool(24, 24, 96, [](int x, int y, int s) {
    const double u = unit_double(mix(2, x, y, s)) - 0.5;
    const auto v = static_cast<float>(1.0 + (x < 12 ? 0.5 : 1.0) * u);
    return Rgb{v, v, v};
  });
  const auto result = sample_denoised_variance(pool, 24 * 24 * 24, {}, test::sampling_context());
  ASSERT_TRUE(result.has_value());
  double quiet = 0, noisy = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x)
      (x < 12 ? quiet : noisy) += result->selection.statistics.n(x, y);
  }
  EXPECT_EQ(quiet + noisy, 24 * 24 * 24);
  EXPECT_NEAR(noisy / quiet, 2.0, 0.1);
}

// Rare bright samples, everywhere alike: who has seen none yet keeps its share.
TEST(DenoisedVariance, LosesLessLightThanNoisyVariances) {
  const SamplePool pool = test::memory_pool(48, 48, 96, [](int x, int y, int s) {
    const double u = unit_double(mix(40, x, y, s));
    const double quiet = 0.2 + 0.6 * unit_double(mix(41, x, y, s));
    const auto v = static_cast<float>(u < 0.1 ? 5.5 : quiet);
    return Rgb{v, v, v};
  });
  const auto energy = [&](bool denoised) {
    DenoisedVarianceOptions options;
    options.denoised = denoised;
    const auto result =
        sample_denoised_variance(pool, 48 * 48 * 8, options, test::sampling_context());
    double sum = 0.0;
    for (const double v : result->selection.statistics.mean[1].pixels())
      sum += v / (48 * 48);
    return sum;
  };
  EXPECT_LT(energy(false), 0.85);
  EXPECT_GT(energy(true), energy(false) + 0.05);
}

}  // namespace
}  // namespace spool
