#include "lib/kernels/truncated_filter.h"

#include <algorithm>
#include <cmath>

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

// to[x] = sum over the taps m of tap(m) rows[(y - m) * stride + x], those inside the image.
void sum_of_rows(const double* rows, std::ptrdiff_t stride, int height, const Taps& taps, int y,
                 int width, double* to, std::vector<const double*>& sources) {
  sources.clear();
  const int first = std::max(taps.first, y - height + 1);
  for (int m = first; m <= std::min(taps.last(), y); ++m)
    sources.push_back(rows + (y - m) * stride);
  if (sources.empty()) return;
  weighted_sum_of_rows(sources.data(), &taps.values[static_cast<std::size_t>(first - taps.first)],
                       sources.size(), width, to);
}

Taps gaussian_of_radius(double sigma, int radius) {
  Taps taps{-radius, {}};
  for (int m = -radius; m <= radius; ++m)
    taps.values.push_back(radius == 0 ? 1.0 : std::exp(-0.5 * m * m / (sigma * sigma)));
  return scaled(taps, 1.0 / tap_sum(taps));
}

// Rows and columns that are summed together: they and their neighbours stay in a core's cache.
constexpr int kRows = 32, kColumns = 256;

// finish(y, x0, x1, to): to[0 .. x1 - x0) holds the sums of row y from column x0 on.
template <class Finish>
Plane sum_and_finish(const Plane& image, const Taps& taps, const Finish& finish) {
  const int width = image.width(), height = image.height();
  const auto rows = std::make_unique_for_overwrite<double[]>(image.size());
  parallel_rows(0, height, [&](int y) {
    std::vector<const double*> sources;
    std::vector<double> padded;
    sum_along_row(image.row(y).data(), taps, width, &rows[image.index(0, y)], padded, sources);
  });
  Plane out(width, height);
  parallel_for(static_cast<std::size_t>((height + kRows - 1) / kRows), [&](std::size_t band) {
    std::vector<const double*> sources;
    const int y0 = static_cast<int>(band) * kRows, y1 = std::min(y0 + kRows, height);
    for (int x0 = 0; x0 < width; x0 += kColumns) {
      const int x1 = std::min(x0 + kColumns, width);
      for (int y = y0; y < y1; ++y) {
        sum_of_rows(rows.get() + x0, width, height, taps, y, x1 - x0, &out(x0, y), sources);
        finish(y, x0, x1, &out(x0, y));
      }
    }
  });
  return out;
}

// Sums over `kernel`, divided by (sum_x sum_y)^power of the taps inside.
Plane sum_over_taps_inside(const Plane& image, const Taps& kernel, const Taps& taps, int power) {
  const std::vector<double> of_x = sums_inside(taps, image.width());
  const std::vector<double> of_y = sums_inside(taps, image.height());
  return sum_and_finish(image, kernel, [&](int y, int x0, int x1, double* to) {
    divide_by_product(&of_x[static_cast<std::size_t>(x0)], of_y[static_cast<std::size_t>(y)],
                      power == 2, x1 - x0, to);
  });
}

}  // namespace

Plane truncated_sum(const Plane& image, const Taps& taps) {
  return sum_and_finish(image, taps, [](int, int, int, double*) {});
}

TapsInside::TapsInside(int width, int height, const Taps& taps)
    : height_(height), taps_(taps), of_row_(sums_inside(taps, width)) {
  if (taps.last() < height + taps.first) whole_ = sums(taps.first, taps.last());
}

std::vector<double> TapsInside::sums(int first, int last) const {
  std::vector<double> sums(of_row_.size(), 0.0);
  for (int m = first; m <= last; ++m) {
    const double tap = taps_.values[static_cast<std::size_t>(m - taps_.first)];
    for (std::size_t x = 0; x < sums.size(); ++x)
      sums[x] += tap * of_row_[x];
  }
  return sums;
}

const std::vector<double>& TapsInside::row(int y, std::vector<double>& memory) const {
  const int first = std::max(taps_.first, y - height_ + 1), last = std::min(taps_.last(), y);
  if (first == taps_.first && last == taps_.last()) return whole_;
  return memory = sums(first, last);
}

Plane truncated_mean(const Plane& image, const Taps& taps) {
  return sum_over_taps_inside(image, taps, taps, 1);
}

Plane truncated_variance(const Plane& v, const Taps& taps, const Taps& squares) {
  return sum_over_taps_inside(v, squares, taps, 2);
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
