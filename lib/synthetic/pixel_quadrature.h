// Means over one pixel of functions that are smooth except across straight lines and circles.
//
// The pixel is cut at every line and circle and where a line crosses either (not where two circles
// cross), first in y, then along each row in x, and each piece is integrated by 16-point
// Gauss-Legendre rules; in y after the substitution y = a + (b - a) s^2 (3 - 2 s), which turns the
// square-root ends of circular arcs into smooth ones. Error: rounding for straight creases and
// polynomials; 1e-9 of a pixel where a circle all but touches a cut.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

namespace spool {

struct Line {  // a X + b Y = c, in pixels
  double a = 0, b = 0, c = 0;
};
struct Circle {
  double x = 0, y = 0, radius = 0;

  // From the centre. std::hypot may have other bits in another glibc.
  double distance(double px, double py) const {
    return std::sqrt((px - x) * (px - x) + (py - y) * (py - y));
  }
};
struct Creases {
  std::vector<Line> lines;
  std::vector<Circle> circles;
};

// First and second moment of the radiance: E[L], E[L^2].
struct Moments {
  double first = 0, second = 0;
  double variance() const { return second - first * first; }
};

// Mean over pixel (x, y) of moments(X, Y), X in [x, x + 1), Y in [y, y + 1).
Moments pixel_mean(int x, int y, const Creases& creases,
                   const std::function<Moments(double, double)>& moments);

}  // namespace spool
