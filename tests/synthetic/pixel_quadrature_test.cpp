#include "lib/synthetic/pixel_quadrature.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace spool {
namespace {

Moments whole_image(int width, int height, const Creases& creases,
                    const std::function<double(double, double)>& value) {
  Moments sum;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Moments m = pixel_mean(x, y, creases, [&](double px, double py) -> Moments {
        return {value(px, py), value(px, py) * value(px, py)};
      });
      sum.first += m.first;
      sum.second += m.second;
    }
  }
  return sum;
}

TEST(PixelQuadrature, AreaOfADiscIsPiRSquared) {
  for (const double radius : {0.3, 1.0, 3.7, 6.0}) {
    const Circle circle{8.2, 7.9, radius};
    const double area = whole_image(16, 16, {{}, {circle}}, [&](double x, double y) {
                          return std::hypot(x - circle.x, y - circle.y) < radius ? 1.0 : 0.0;
                        }).first;
    EXPECT_NEAR(area, std::numbers::pi * radius * radius, 2e-9) << radius;
  }
}

TEST(PixelQuadrature, AreaUnderALineIsThatOfTheTrapezoid) {
  const Line line{0.3, 1.0, 6.1};  // y = 6.1 - 0.3 x
  const double area = whole_image(10, 10, {{line}, {}}, [&](double x, double y) {
                        return line.a * x + line.b * y < line.c ? 1.0 : 0.0;
                      }).first;
  EXPECT_NEAR(area, 10 * (6.1 + 3.1) / 2, 1e-11);
}

TEST(PixelQuadrature, CrossingCreasesAreFound) {
  // A quarter disc: circle cut by two lines through its centre, in the middle of a pixel.
  const Creases creases{{{1.0, 0.0, 4.4}, {0.0, 1.0, 4.3}}, {{4.4, 4.3, 2.5}}};
  const double area = whole_image(9, 9, creases, [&](double x, double y) {
                        return x > 4.4 && y > 4.3 && std::hypot(x - 4.4, y - 4.3) < 2.5 ? 1.0 : 0.0;
                      }).first;
  EXPECT_NEAR(area, std::numbers::pi * 2.5 * 2.5 / 4, 2e-9);
}

TEST(PixelQuadrature, PolynomialsAreExact) {
  const Moments m =
      pixel_mean(2, 3, {}, [](double x, double y) -> Moments { return {x * y, x * x * y * y}; });
  EXPECT_NEAR(m.first, 2.5 * 3.5, 1e-12);
  EXPECT_NEAR(m.second, (27.0 - 8.0) / 3 * (64.0 - 27.0) / 3, 1e-11);
}

}  // namespace
}  // namespace spool
