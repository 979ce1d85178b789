#include "lib/filters/truncated_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {
namespace {

// sum over the taps inside [0, n) of tap(m), for the output at x.
std::vector<double> sums_inside(const Taps& taps, int n) {
  std::vector<double> sums(static_cast<std::size_t>(n), 0.0);
  for (int x = 0; x < n; ++x) {
    for (int m = taps.first; m <= taps.last(); ++m) {
      if (x - m >= 0 && x - m < n) {
        sums[static_cast<std::size_t>(x)] += taps.values[static_cast<std::size_t>(m - taps.first)];
      }
    }
  }
  return sums;
}

// Divides by (sum_x sum_y)^power.
void normalise(Plane& image, const Taps& taps, int power) {
  const std::vector<double> of_x = sums_inside(taps, image.width());
  const std::vector<double> of_y = sums_inside(taps, image.height());
  parallel_rows(0, image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      const double sum = of_x[static_cast<std::size_t>(x)] * of_y[static_cast<std::size_t>(y)];
      image(x, y) /= power == 1 ? sum : sum * sum;
    }
  });
}

}  // namespace

Plane truncated_sum(const Plane& image, const Taps& taps) {
  const int width = image.width(), height = image.height();
  Plane rows(width, height), out(width, height);
  parallel_rows(0, height, [&](int y) {
    const double* in = image.row(y).data();
    double* __restrict to = rows.row(y).data();
    for (int m = taps.first; m <= taps.last(); ++m) {
      const double tap = taps.values[static_cast<std::size_t>(m - taps.first)];
      const int end = std::min(width, width + m);
      for (int x = std::max(0, m); x < end; ++x)
        to[x] += tap * in[x - m];
    }
  });
  parallel_rows(0, height, [&](int y) {
    double* __restrict to = out.row(y).data();
    for (int m = taps.first; m <= taps.last(); ++m) {
      if (y - m < 0 || y - m >= height) continue;
      const double tap = taps.values[static_cast<std::size_t>(m - taps.first)];
      const double* in = rows.row(y - m).data();
      for (int x = 0; x < width; ++x)
        to[x] += tap * in[x];
    }
  });
  return out;
}

Plane truncated_mean(const Plane& image, const Taps& taps) {
  Plane mean = truncated_sum(image, taps);
  normalise(mean, taps, 1);
  return mean;
}

Plane truncated_variance(const Plane& v, const Taps& taps, const Taps& squares) {
  Plane variance = truncated_sum(v, squares);
  normalise(variance, taps, 2);
  return variance;
}

Taps squared_taps(const Taps& taps) {
  Taps squares = taps;
  for (double& tap : squares.values)
    tap *= tap;
  return squares;
}

Taps convolved_taps(const Taps& a, const Taps& b) {
  Taps result{a.first + b.first, std::vector<double>(a.values.size() + b.values.size() - 1, 0.0)};
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    for (std::size_t j = 0; j < b.values.size(); ++j)
      result.values[i + j] += a.values[i] * b.values[j];
  }
  return result;
}

Taps peak_normalised(const Taps& taps) {
  return scaled(taps, 1.0 / taps.values[static_cast<std::size_t>(-taps.first)]);
}

double tap_sum(const Taps& taps) {
  double sum = 0.0;
  for (const double tap : taps.values)
    sum += tap;
  return sum;
}

Taps floor_gaussian_taps(double sigma) {
  const int radius = static_cast<int>(std::floor(3.0 * sigma));
  Taps taps{-radius, {}};
  for (int m = -radius; m <= radius; ++m)
    taps.values.push_back(radius == 0 ? 1.0 : std::exp(-0.5 * m * m / (sigma * sigma)));
  return scaled(taps, 1.0 / tap_sum(taps));
}

Taps pixel_filter_taps() {
  const double side = std::exp(-2.0) - std::exp(-8.0), middle = 1.0 - std::exp(-8.0);
  const double sum = middle + 2.0 * side;
  return {-1, {side / sum, middle / sum, side / sum}};
}

}  // namespace spool
