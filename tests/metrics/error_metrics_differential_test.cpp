#include <set>

#include <gtest/gtest.h>

#include "lib/metrics/error_metrics.h"
#include "lib/metrics/error_parts.h"
#include "tests/reference/error_metrics_reference.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::add_noise;
using test::uniform_image;

TEST(ErrorMetrics, EqualTheSlowTwin) {
  struct Case {
    int width, height;
    bool variance, denominator, holes;
    MetricOptions options;
  };
  MetricOptions plain, literal, wide;
  literal.rel_scale = RelativeScale::kNone;
  literal.rel_denominator = RelativeDenominator::kLuminance;
  literal.rel_eps = 1e-3;
  wide.trim = 0.07;
  const Case cases[] = {{1, 1, false, false, false, plain},  {17, 5, true, false, false, plain},
                        {64, 64, true, true, true, literal}, {33, 70, false, true, true, wide},
                        {100, 41, true, true, false, plain}, {16, 16, false, false, true, wide}};
  const std::set<std::string> perceptual = {"ssim", "ms_ssim", "flip_ldr", "flip_hdr"};
  std::uint64_t seed = 20;
  for (const Case& c : cases) {
    seed += 10;
    JudgingReference reference{uniform_image(c.width, c.height, seed, -0.1, 3.0), {}, {}};
    if (c.variance) reference.variance = uniform_image(c.width, c.height, seed + 1, 0.0, 0.01);
    if (c.denominator) reference.denominator = uniform_image(c.width, c.height, seed + 2, 0.0, 3.0);
    RgbImage image = add_noise(reference.mean, seed + 3, 0.2);
    if (c.holes) {
      image[0](2, 3) = std::numeric_limits<double>::quiet_NaN();
      reference.mean[1](0, 1) = std::numeric_limits<double>::infinity();
    }
    const MetricTable table = error_metrics(image, reference, c.options);
    for (const MetricDescription& metric : metrics()) {
      if (perceptual.contains(metric.name)) continue;  // twins of their own
      const double slow = reference::metric(metric.name, image, reference, c.options);
      const double fast = table[metric.name].value;
      if (std::isnan(slow)) {
        EXPECT_TRUE(std::isnan(fast)) << metric.name;
        continue;
      }
      // 1e-11 covers the cancellation in debiased sums; the sums themselves agree to 1e-15 N.
      EXPECT_NEAR(fast, slow, 1e-11 * (1.0 + std::abs(slow)))
          << metric.name << " at " << c.width << "x" << c.height;
    }
    for (const bool relative : {false, true}) {
      const ErrorSupport fast = relative ? table.relative : table.squared;
      const ErrorSupport slow = reference::error_support(relative, image, reference, c.options);
      EXPECT_NEAR(fast.worst_share, slow.worst_share, 1e-12);
      EXPECT_EQ(fast.half_pixels, slow.half_pixels);
      EXPECT_EQ(std::isnan(fast.reference_noise), !c.variance);
      if (c.variance) {
        EXPECT_NEAR(fast.reference_noise, slow.reference_noise, 1e-12);
      }
    }
  }
}

TEST(ErrorMetrics, OfTheReferenceItselfAreZero) {
  const JudgingReference reference{
      uniform_image(21, 17, 5, 0.0, 3.0), uniform_image(21, 17, 6, 0.0, 0.01), {}};
  RgbImage image = reference.mean;
  const MetricTable table = error_metrics(image, reference);
  for (const char* name : {"mse", "mse_g", "relmse", "relmse_trimmed", "mse_equal_energy"}) {
    EXPECT_EQ(table[name].value, 0.0) << name;
    EXPECT_EQ(table[name].standard_error, 0.0) << name;
    EXPECT_EQ(reference::metric(name, image, reference, {}), 0.0) << name;
  }
  EXPECT_TRUE(is_the_reference(image, reference.mean));
  image[1](3, 4) *= 1.0005;
  EXPECT_LT(error_metrics(image, reference)["mse"].value, 0.0);
  EXPECT_TRUE(is_the_reference(image, reference.mean));
  image[1](3, 4) *= 1.001;
  EXPECT_FALSE(is_the_reference(image, reference.mean));
  image[1](3, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_the_reference(image, reference.mean));
}

TEST(ErrorParts, EqualTheSlowTwin) {
  for (const auto denominator :
       {RelativeDenominator::kPerChannel, RelativeDenominator::kLuminance}) {
    MetricOptions options;
    options.rel_denominator = denominator;
    JudgingReference reference{uniform_image(41, 19, 3, -0.1, 3.0),
                               uniform_image(41, 19, 4, 0.0, 0.01),
                               uniform_image(41, 19, 5, 0.0, 3.0)};
    RgbImage a = add_noise(reference.mean, 6, 0.2), b = add_noise(reference.mean, 7, 0.3);
    a[1](3, 3) = std::numeric_limits<double>::quiet_NaN();
    b[0](9, 1) = std::numeric_limits<double>::infinity();
    reference.mean[2](8, 8) = std::numeric_limits<double>::quiet_NaN();
    RgbImage both = a;
    both[0](9, 1) = std::numeric_limits<double>::quiet_NaN();
    const double scale = error_metrics(both, reference, options).relative_scale;
    const ErrorParts parts = error_parts(a, b, reference, scale, options);
    EXPECT_EQ(parts.pixels, 41u * 19u - 3u);
    const auto slow = [&](bool bias2, bool relative) {
      return reference::error_part(bias2, relative, a, b, reference, options);
    };
    EXPECT_NEAR(parts.bias2, slow(true, false), 1e-13);
    EXPECT_NEAR(parts.variance, slow(false, false), 1e-13);
    EXPECT_NEAR(parts.relative_bias2, slow(true, true), 1e-12);
    EXPECT_NEAR(parts.relative_variance, slow(false, true), 1e-12);
  }
}

}  // namespace
}  // namespace spool
