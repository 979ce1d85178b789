#include "lib/directions/sign_filter.h"

#include <gtest/gtest.h>

#include <numbers>

namespace spool {
namespace {

TEST(SignFilter, ResponseIsNearTheSignBetweenZeroAndTwoPi) {
  double lowest = 2.0, highest = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const double u = 0.3 + i / 2000.0 * (2.0 * std::numbers::pi - 0.6);
    const double response = sign_response(SignTaps::kPkva12, u);
    lowest = std::min(lowest, response);
    highest = std::max(highest, response);
    EXPECT_DOUBLE_EQ(sign_response(SignTaps::kPkva12, -u), -response);
  }
  EXPECT_NEAR(lowest, 0.66, 0.01);
  EXPECT_NEAR(highest, 1.01, 0.01);
  EXPECT_NEAR(sign_response(SignTaps::kPkva12, 0.215), 0.5, 0.005);
}

TEST(SignFilter, CoefficientsAlternateTheLadderFilter) {
  EXPECT_EQ(sign_coefficients(SignTaps::kPkva6).size(), 3u);
  EXPECT_EQ(sign_coefficients(SignTaps::kPkva8).size(), 4u);
  const auto s = sign_coefficients(SignTaps::kPkva12);
  const double v[] = {0.6300, -0.1930, 0.0972, -0.0526, 0.0272, -0.0144};
  ASSERT_EQ(s.size(), 6u);
  for (std::size_t j = 0; j < 6; ++j)
    EXPECT_EQ(s[j], j % 2 == 0 ? v[j] : -v[j]);
}

}  // namespace
}  // namespace spool
