#include "lib/core/arctangent.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

double error_in_ulp(double value, long double exact) {
  const auto nearest = static_cast<double>(exact);
  const double ulp = std::nextafter(nearest, std::numeric_limits<double>::infinity()) - nearest;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) /
                             static_cast<long double>(ulp));
}

TEST(AtanUpTo1, IsWithin2Ulp) {
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 1u << 20; ++i) {
    const double q = unit_double(mix(7, i)) * (i % 4 == 0 ? 1e-3 : 1.0);
    worst = std::max(worst, error_in_ulp(atan_up_to_1(q), std::atan(static_cast<long double>(q))));
  }
  RecordProperty("largest_ulp", std::to_string(worst));
  EXPECT_LT(worst, 2.0);
  EXPECT_EQ(atan_up_to_1(0.0), 0.0);
  EXPECT_NEAR(atan_up_to_1(1.0), std::numbers::pi / 4.0, 1e-16);
}

TEST(LineDirection, IsThatOfAtan2WithoutItsSign) {
  for (std::uint64_t i = 0; i < 1u << 18; ++i) {
    const double dx = 2.0 * unit_double(mix(8, i, 0)) - 1.0;
    const double dy = 2.0 * unit_double(mix(8, i, 1)) - 1.0;
    double expected = std::fmod(std::atan2(dy, dx) * (180.0 / std::numbers::pi), 180.0);
    if (expected < 0.0) expected += 180.0;
    ASSERT_NEAR(line_direction(dx, dy), expected, 2e-13) << dx << " " << dy;
  }
}

TEST(LineDirection, OfAxesDiagonalsAndOfNone) {
  EXPECT_EQ(line_direction(0.0, 0.0), 0.0);
  for (const double side : {-2.0, 3.0}) {
    EXPECT_EQ(line_direction(side, 0.0), 0.0);
    EXPECT_EQ(line_direction(side, -0.0), 0.0);
    EXPECT_EQ(line_direction(0.0, side), 90.0);
    EXPECT_EQ(line_direction(-0.0, side), 90.0);
    EXPECT_NEAR(line_direction(side, side), 45.0, 1e-14);
    EXPECT_NEAR(line_direction(side, -side), 135.0, 1e-13);
  }
  EXPECT_LT(line_direction(1.0, -1e-300), 180.0);
  EXPECT_GE(line_direction(1.0, -1e-300), 0.0);
}

}  // namespace
}  // namespace spool
