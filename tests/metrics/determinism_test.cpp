#include <bit>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/metrics/error_metrics.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

TEST(ErrorMetrics, BitsDoNotDependOnTheNumberOfThreads) {
  const RgbImage r = test::uniform_image(200, 150, 1);
  const RgbImage i = test::add_noise(r, 2, 0.2);
  MetricOptions options;
  options.perceptual = Perceptual::kAll;
  const auto bits = [&](int threads) {
    const ThreadLimit limit(threads);
    std::vector<std::uint64_t> values;
    for (const MetricValue& metric : error_metrics(i, {r, {}, {}}, options).values) {
      values.push_back(std::bit_cast<std::uint64_t>(metric.value));
      values.push_back(std::bit_cast<std::uint64_t>(metric.standard_error));
    }
    return values;
  };
  const std::vector<std::uint64_t> once = bits(1);
  for (const int threads : {2, 3, 8})
    EXPECT_EQ(bits(threads), once) << threads;
}

}  // namespace
}  // namespace spool
