#include "lib/statistics/grown_variance.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/statistics/window_sums.h"

namespace spool {
namespace {

constexpr double kTooFew = 10.0, kEnough = 20.0;  // pieces that a mean rests on

// Pieces of a line's window.
double inside(int at, int radius, int length) {
  return std::min(at + radius, length - 1) - std::max(at - radius, 0) + 1;
}

}  // namespace

Plane grown_variance(const Plane& variance, int largest) {
  const int width = variance.width(), height = variance.height();
  Plane squares = variance;
  for (double& v : squares.pixels())
    v *= v;
  Plane grown(width, height), left(width, height, 1.0);
  for (int radius = 1; radius <= largest; radius *= 2) {
    const bool last = 2 * radius > largest;
    const Plane sum = window_sums(variance, radius), square = window_sums(squares, radius);
    parallel_rows(0, height, [&](int y) {
      const double rows = inside(y, radius, height);
      for (int x = 0; x < width; ++x) {
        const double s = sum(x, y), q = square(x, y);
        const double pieces = q > 0.0 ? s * s / q : 0.0;
        const double enough = std::clamp((pieces - kTooFew) / (kEnough - kTooFew), 0.0, 1.0);
        const double share = last ? left(x, y) : left(x, y) * enough;
        grown(x, y) += share * s / (rows * inside(x, radius, width));
        left(x, y) -= share;
      }
    });
  }
  return grown;
}

}  // namespace spool
