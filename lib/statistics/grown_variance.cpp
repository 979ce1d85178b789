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

Plane squared(const Plane& plane) {
  Plane squares = plane;
  for (double& v : squares.pixels())
    v *= v;
  return squares;
}

// 1 where the means of a window differ by no more than their noise, 0 from twice that on.
Plane alike(const Plane& mean, const Plane& variance_sum, int radius) {
  const int width = mean.width(), height = mean.height();
  const Plane sum = window_sums(mean, radius);
  Plane result = window_sums(squared(mean), radius);
  parallel_rows(0, height, [&](int y) {
    const double rows = inside(y, radius, height);
    for (int x = 0; x < width; ++x) {
      const double count = rows * inside(x, radius, width);
      const double spread = result(x, y) - sum(x, y) * sum(x, y) / count;
      const double noise = variance_sum(x, y) * (count - 1.0) / count;
      // One piece differs from none.
      const double none = count < 2.0 ? 1.0 : 0.0;
      result(x, y) = noise > 0.0 ? std::clamp(2.0 - spread / noise, 0.0, 1.0) : none;
    }
  });
  return result;
}

}  // namespace

Plane grown_variance(const Plane& variance, int largest, const Plane* mean) {
  const int width = variance.width(), height = variance.height();
  const Plane squares = squared(variance);
  Plane grown(width, height), left(width, height, 1.0), smaller(width, height);
  for (int radius = 1; radius <= largest; radius *= 2) {
    const bool last = 2 * radius > largest;
    const Plane sum = window_sums(variance, radius), square = window_sums(squares, radius);
    const Plane like = mean ? alike(*mean, sum, radius) : Plane(width, height, 1.0);
    parallel_rows(0, height, [&](int y) {
      const double rows = inside(y, radius, height);
      for (int x = 0; x < width; ++x) {
        const double s = sum(x, y), q = square(x, y);
        const double pieces = q > 0.0 ? s * s / q : 0.0;
        const double enough =
            last ? 1.0 : std::clamp((pieces - kTooFew) / (kEnough - kTooFew), 0.0, 1.0);
        const double pooled = s / (rows * inside(x, radius, width));
        grown(x, y) +=
            left(x, y) * (like(x, y) * enough * pooled + (1.0 - like(x, y)) * smaller(x, y));
        left(x, y) *= like(x, y) * (1.0 - enough);
        smaller(x, y) = pooled;
      }
    });
  }
  return grown;
}

}  // namespace spool
