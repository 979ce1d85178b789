#include "lib/kernels/truncated_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/pyramid/row_sums.h"

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

SPOOL_VECTOR_CLONES
void divide_by_product(const double* of_x, double of_y, bool squared, int width,
                       double* __restrict row) {
  if (squared) {
    for (int x = 0; x < width; ++x)
      row[x] /= (of_x[x] * of_y) * (of_x[x] * of_y);
  } else {
    for (int x = 0; x < width; ++x)
      row[x] /= of_x[x] * of_y;
  }
}

// Divides by (sum_x sum_y)^power.
void normalise(Plane& image, const Taps& taps, int power) {
  const std::vector<double> of_x = sums_inside(taps, image.width());
  const std::vector<double> of_y = sums_inside(taps, image.height());
  parallel_rows(0, image.height(), [&](int y) {
    divide_by_product(of_x.data(), of_y[static_cast<std::size_t>(y)], power == 2, image.width(),
                      image.row(y).data());
  });
}

// to[x] = sum over the taps m of tap(m) in[x - m], those inside the row: the row gets zeros on
// both sides, so that a window wider than the image is as fast as any. `padded`: memory for it.
void sum_along_row(const double* in, const Taps& taps, int width, double* to,
                   std::vector<double>& padded, std::vector<const double*>& sources) {
  const int left = std::max(taps.last(), 0), right = std::max(-taps.first, 0);
  padded.assign(static_cast<std::size_t>(left + width + right), 0.0);
  std::copy(in, in + width, padded.begin() + left);
  sources.clear();
  for (int m = taps.first; m <= taps.last(); ++m)
    sources.push_back(padded.data() + left - m);
  weighted_sum_of_rows(sources.data(), taps.values.data(), sources.size(), width, to);
}

// to[x] = sum over the taps m of tap(m) rows(x, y - m), those inside the image, x0 <= x < x1.
void sum_of_rows(const Plane& rows, const Taps& taps, int y, int x0, int x1, double* to,
                 std::vector<const double*>& sources) {
  sources.clear();
  const int first = std::max(taps.first, y - rows.height() + 1);
  for (int m = first; m <= std::min(taps.last(), y); ++m)
    sources.push_back(&rows(x0, y - m));
  if (sources.empty()) return;
  weighted_sum_of_rows(sources.data(), &taps.values[static_cast<std::size_t>(first - taps.first)],
                       sources.size(), x1 - x0, to);
}

Taps gaussian_of_radius(double sigma, int radius) {
  Taps taps{-radius, {}};
  for (int m = -radius; m <= radius; ++m)
    taps.values.push_back(radius == 0 ? 1.0 : std::exp(-0.5 * m * m / (sigma * sigma)));
  return scaled(taps, 1.0 / tap_sum(taps));
}

// Rows and columns that are summed together: they and their neighbours stay in a core's cache.
constexpr int kRows = 32, kColumns = 256;

}  // namespace

Plane truncated_sum(const Plane& image, const Taps& taps) {
  const int width = image.width(), height = image.height();
  Plane rows(width, height), out(width, height);
  parallel_rows(0, height, [&](int y) {
    std::vector<const double*> sources;
    std::vector<double> padded;
    sum_along_row(image.row(y).data(), taps, width, rows.row(y).data(), padded, sources);
  });
  parallel_for(static_cast<std::size_t>((height + kRows - 1) / kRows), [&](std::size_t band) {
    std::vector<const double*> sources;
    const int y0 = static_cast<int>(band) * kRows, y1 = std::min(y0 + kRows, height);
    for (int x0 = 0; x0 < width; x0 += kColumns) {
      const int x1 = std::min(x0 + kColumns, width);
      for (int y = y0; y < y1; ++y)
        sum_of_rows(rows, taps, y, x0, x1, &out(x0, y), sources);
    }
  });
  return out;
}

Plane truncated_sum_of_ones(int width, int height, const Taps& taps) {
  // Rows whose window no border cuts are alike.
  const std::vector<double> row = sums_inside(taps, width);
  Plane out(width, height);
  const auto fill = [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int m = std::max(taps.first, y - height + 1); m <= std::min(taps.last(), y); ++m)
        sum += taps.values[static_cast<std::size_t>(m - taps.first)] *
               row[static_cast<std::size_t>(x)];
      out(x, y) = sum;
    }
  };
  int whole = -1;
  for (int y = 0; y < height; ++y) {
    const bool cut = y < taps.last() || y - taps.first >= height;
    if (cut || whole < 0) {
      fill(y);
      if (!cut) whole = y;
    } else {
      std::copy(out.row(whole).begin(), out.row(whole).end(), out.row(y).begin());
    }
  }
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
  return gaussian_of_radius(sigma, static_cast<int>(std::floor(3.0 * sigma)));
}

Taps four_sigma_taps(double sigma) {
  return gaussian_of_radius(sigma, static_cast<int>(std::floor(4.0 * sigma + 0.5)));
}

Taps pixel_filter_taps() {
  const double side = std::exp(-2.0) - std::exp(-8.0), middle = 1.0 - std::exp(-8.0);
  const double sum = middle + 2.0 * side;
  return {-1, {side / sum, middle / sum, side / sum}};
}

}  // namespace spool
