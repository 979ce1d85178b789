#include "lib/filters/directional/filter_offsets.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lib/directions/band_angles.h"

namespace spool {
namespace {

std::vector<double> sorted_tangents(int levels) {
  std::vector<double> beta = band_tangents(levels);
  std::sort(beta.begin(), beta.end());
  return beta;
}

const std::vector<double> kDelta = {3.0, 0.7, 1.9, 0.25, 2.2, 5.0, 0.9, 1.4};

// Largest jump of delta(b) over 3600 angles and both sides of every beta, the wrap at 180 included.
double largest_jump(Eq12 form, int levels) {
  const std::vector<double> beta = sorted_tangents(levels);
  std::vector<double> angles;
  for (int i = 0; i < 3600; ++i)
    angles.push_back(0.05 * i);
  angles.push_back(std::nextafter(180.0, 0.0));
  for (const double b : beta) {
    angles.push_back(b);
    angles.push_back(std::nextafter(b, -1.0));
  }
  double jump = 0.0;
  for (const double b : angles) {
    const double step = 1e-9;
    const double here = interpolated_width(sector_of(b, beta), kDelta, form);
    const double there = interpolated_width(sector_of(b + step, beta), kDelta, form);
    jump = std::max(jump, std::abs(here - there));
  }
  return jump;
}

TEST(FilterOffsets, CorrectedEq12IsContinuousAtEveryAngle) {
  for (const int levels : {1, 2, 3})
    EXPECT_LT(largest_jump(Eq12::kCorrected, levels), 1e-8) << levels;
}

TEST(FilterOffsets, LiteralEq12JumpsSoTheTestCanSeeTheMisprint) {
  // With two directions the misprint only exchanges them; from four on it tears the circle.
  for (const int levels : {2, 3})
    EXPECT_GT(largest_jump(Eq12::kLiteral, levels), 0.4) << levels;
}

TEST(FilterOffsets, WidthAtADirectionIsThatDirectionsWidth) {
  const std::vector<double> beta = sorted_tangents(3);
  for (std::size_t i = 0; i < beta.size(); ++i) {
    for (const double turn : {-360.0, -180.0, 0.0, 180.0, 720.0}) {
      EXPECT_NEAR(interpolated_width(sector_of(beta[i] + turn, beta), kDelta, Eq12::kCorrected),
                  kDelta[i], 1e-9);
    }
  }
}

TEST(FilterOffsets, SectorsAreHalfOpenAndHoldEveryAngle) {
  const std::vector<double> beta = sorted_tangents(3);
  for (int i = -7200; i <= 7200; ++i) {
    const Sector s = sector_of(0.05 * i, beta);
    EXPECT_GE(s.t, 0.0);
    EXPECT_LT(s.t, 1.0);
    EXPECT_EQ(s.upper, (s.lower + 1) % 8);
  }
  for (std::size_t i = 0; i < beta.size(); ++i) {
    EXPECT_EQ(sector_of(beta[i], beta).lower, static_cast<int>(i));
    EXPECT_EQ(sector_of(beta[i], beta).t, 0.0);
    EXPECT_EQ(sector_of(std::nextafter(beta[i], -1.0), beta).upper, static_cast<int>(i));
  }
  EXPECT_LT(sector_of(-1e-20, beta).t, 1.0);
}

TEST(FilterOffsets, HalfPlaneAndItsMirrorMakeTheWholeWindow) {
  const std::vector<double> beta = sorted_tangents(2);
  for (int level = 1; level <= 4; ++level) {
    for (const auto window : {FilterWindow::kDisc, FilterWindow::kSquare}) {
      const int radius = filter_radius(level);
      std::size_t expected = 0;
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          if (window == FilterWindow::kSquare || dx * dx + dy * dy <= radius * radius) ++expected;
        }
      }
      const auto offsets = filter_offsets(level, beta, window);
      EXPECT_EQ(2 * offsets.size() + 1, expected);
      for (const FilterOffset& o : offsets) {
        EXPECT_TRUE(o.dy > 0 || (o.dy == 0 && o.dx > 0));
        // -offset lies on the same line: one weight serves both.
        const Sector mirror = sector_of(std::atan2(-o.dy, -o.dx) * 180.0 / std::numbers::pi, beta);
        EXPECT_NEAR(interpolated_width(mirror, kDelta, Eq12::kCorrected),
                    interpolated_width(o.sector, kDelta, Eq12::kCorrected), 1e-12);
      }
    }
  }
}

TEST(FilterOffsets, LargestDiscStaysBelow200Pieces) {
  const auto offsets = filter_offsets(4, sorted_tangents(3), FilterWindow::kDisc);
  EXPECT_LT(2 * offsets.size() + 1, 200u);
}

}  // namespace
}  // namespace spool
