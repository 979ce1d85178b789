#include "lib/filters/directional/anisotropic_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/directional/filter_offsets.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kLeastWeight = 1e-300;

// `plane` inside a border of zeros, so that neighbours need no test: outside, the weight is 0.
template <class T, class From>
Image<T> padded(const Image<From>& plane, int border) {
  Image<T> result(plane.width() + 2 * border, plane.height() + 2 * border);
  parallel_rows(0, plane.height(), [&](int y) {
    for (int x = 0; x < plane.width(); ++x)
      result(x + border, y + border) = static_cast<T>(plane(x, y));
  });
  return result;
}

// Weight of a piece beside omega.
Plane piece_weights(const CountImage& n, FilterWeighting weighting) {
  Plane weights(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i) {
    weights[i] = weighting == FilterWeighting::kPerSample ? n[i] : (n[i] > 0 ? 1.0 : 0.0);
  }
  return weights;
}

template <class T>
struct PaddedInput {
  int border = 0;
  Image<T> weight;
  RgbImage mean, variance;
};

// Sums of one run of pieces of equal level in a row.
struct RunSums {
  std::vector<double> before, after;  // weights of the neighbours at -offset and +offset
  std::vector<double> weight;
  std::array<std::vector<double>, 3> value, variance;

  void resize(std::size_t n) {
    before.resize(n);
    after.resize(n);
    weight.resize(n);
    for (std::size_t c = 0; c < 3; ++c) {
      value[c].resize(n);
      variance[c].resize(n);
    }
  }
};

// Weights of the two neighbours at one offset and its opposite, for `count` pieces whose widths
// along the two nearest directions are given.
template <class T>
SPOOL_VECTOR_CLONES void compute_weights(const T* __restrict lower, const T* __restrict upper,
                                         T lower_share, T half_squared_distance,
                                         const T* __restrict before, const T* __restrict after,
                                         int count, double* __restrict w_before,
                                         double* __restrict w_after, double* __restrict total) {
  const T upper_share = T{1} - lower_share;
  for (int i = 0; i < count; ++i) {
    const T delta = lower_share * lower[i] + upper_share * upper[i];        // (12)
    const T omega = exp_negative(half_squared_distance / (delta * delta));  // (11)
    w_before[i] = static_cast<double>(omega * before[i]);
    w_after[i] = static_cast<double>(omega * after[i]);
    total[i] += w_before[i] + w_after[i];
  }
}

// Adds both neighbours to the sums of a channel.
SPOOL_VECTOR_CLONES
void add_neighbours(const double* __restrict w_before, const double* __restrict w_after,
                    const double* __restrict before, const double* __restrict after,
                    const double* __restrict centre, int count, double* __restrict value) {
  for (int i = 0; i < count; ++i) {
    value[i] += w_before[i] * (before[i] - centre[i]) + w_after[i] * (after[i] - centre[i]);
  }
}

SPOOL_VECTOR_CLONES
void add_variances(const double* __restrict w_before, const double* __restrict w_after,
                   const double* __restrict before, const double* __restrict after, int count,
                   double* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    variance[i] += w_before[i] * w_before[i] * before[i] + w_after[i] * w_after[i] * after[i];
  }
}

// Eq 10 for pieces x0 .. x0 + count - 1 of row y, all of one level.
template <class T>
void filter_run(const PaddedInput<T>& input, const FilterWidths<T>& widths,
                const std::vector<FilterOffset>& offsets, Eq12 eq12, int x0, int y, int count,
                RunSums& sums, FilteredPieces& out, GuardCounts& caught) {
  const auto stride = static_cast<std::ptrdiff_t>(input.weight.width());
  const std::size_t centre = input.weight.index(x0 + input.border, y + input.border);
  sums.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double w = static_cast<double>(input.weight[centre + at]);
    sums.weight[at] = w;
    for (std::size_t c = 0; c < 3; ++c) {
      sums.value[c][at] = 0.0;
      sums.variance[c][at] = w * w * input.variance[c][centre + at];
    }
  }
  for (const FilterOffset& offset : offsets) {
    const auto lower = static_cast<std::size_t>(offset.sector.lower);
    const auto upper = static_cast<std::size_t>(offset.sector.upper);
    const auto step = static_cast<std::size_t>(offset.dy * stride + offset.dx);
    const std::size_t before = centre - step, after = centre + step;
    compute_weights(&widths.delta[lower](x0, y), &widths.delta[upper](x0, y),
                    static_cast<T>(lower_weight(offset.sector, eq12)),
                    static_cast<T>(0.5 * offset.squared_distance), &input.weight[before],
                    &input.weight[after], count, sums.before.data(), sums.after.data(),
                    sums.weight.data());
    for (std::size_t c = 0; c < 3; ++c) {
      const Plane& mean = input.mean[c];
      add_neighbours(sums.before.data(), sums.after.data(), &mean[before], &mean[after],
                     &mean[centre], count, sums.value[c].data());
      add_variances(sums.before.data(), sums.after.data(), &input.variance[c][before],
                    &input.variance[c][after], count, sums.variance[c].data());
    }
  }
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double total = sums.weight[at];
    const bool vanished = !(total >= kLeastWeight);
    if (vanished) caught.add(Guard::kZeroWeight);
    for (std::size_t c = 0; c < 3; ++c) {
      if (vanished) continue;  // the filled mean, and its variance, are there already
      out.image[c](x0 + i, y) += sums.value[c][at] / total;  // (10)
      out.variance[c](x0 + i, y) = sums.variance[c][at] / (total * total);
    }
  }
}

// By how much the variance grows when `mean` was filtered with taps x taps before: its neighbours
// are then no longer independent. Exact for the round filter of size 2^level over even variance;
// 1 for taps of length 1.
double correlation_factor(const Taps& taps, int level, double sigma, const FilterOptions& options) {
  if (taps.values.size() == 1 || level == 0) return 1.0;
  const int reach = static_cast<int>(taps.values.size());
  const int radius = filter_radius(level);
  const int middle = radius + reach;
  Plane kernel(2 * middle + 1, 2 * middle + 1);
  kernel(middle, middle) = 1.0;
  const std::vector<double> any_direction = {0.0};
  for (const FilterOffset& o : filter_offsets(level, any_direction, options.window)) {
    const double omega = std::exp(-0.5 * o.squared_distance / (sigma * sigma));
    kernel(middle + o.dx, middle + o.dy) = omega;
    kernel(middle - o.dx, middle - o.dy) = omega;
  }
  const auto squares = [](const Plane& plane) {
    double sum = 0.0;
    for (const double v : plane.pixels())
      sum += v * v;
    return sum;
  };
  double tap_squares = 0.0;
  for (const double tap : taps.values)
    tap_squares += tap * tap;
  return squares(convolve(kernel, taps)) / (squares(kernel) * tap_squares * tap_squares);
}

}  // namespace

template <class T>
void filter_in_place(const CountImage& n, const CountImage& level, const FilterWidths<T>& widths,
                     const FilterOptions& options, FilteredPieces& pieces, GuardCounts& guards) {
  const int width = level.width(), height = level.height();
  int largest = 0;
  for (const int k : level.pixels())
    largest = std::max(largest, k);
  if (largest == 0) return;
  std::vector<std::vector<FilterOffset>> offsets(1);
  for (int k = 1; k <= largest; ++k)
    offsets.push_back(filter_offsets(k, widths.beta, options.window));

  PaddedInput<T> from;
  from.border = filter_radius(largest);
  from.weight = padded<T>(piece_weights(n, options.weighting), from.border);
  for (std::size_t c = 0; c < 3; ++c) {
    from.mean[c] = padded<double>(pieces.image[c], from.border);
    from.variance[c] = padded<double>(pieces.variance[c], from.border);
  }

  std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
  parallel_rows(0, height, [&](int y) {
    RunSums sums;
    for (int x = 0; x < width;) {
      const int k = level(x, y);
      int end = x + 1;
      while (end < width && level(end, y) == k)
        ++end;
      if (k > 0) {
        filter_run(from, widths, offsets[static_cast<std::size_t>(k)], options.eq12, x, y, end - x,
                   sums, pieces, caught[static_cast<std::size_t>(y)]);
      }
      x = end;
    }
  });
  for (const GuardCounts& row : caught)
    guards += row;
}

void correct_variance(const Taps& taps, const CountImage& level, double sigma_max,
                      const FilterOptions& options, RgbImage& variance) {
  std::vector<double> factors;  // by level
  for (const int k : level.pixels()) {
    for (int next = static_cast<int>(factors.size()); next <= k; ++next)
      factors.push_back(correlation_factor(taps, next, std::ldexp(sigma_max, next), options));
  }
  for (Plane& channel : variance) {
    for (std::size_t i = 0; i < channel.size(); ++i)
      channel[i] *= factors[static_cast<std::size_t>(level[i])];
  }
}

template void filter_in_place(const CountImage&, const CountImage&, const FilterWidths<double>&,
                              const FilterOptions&, FilteredPieces&, GuardCounts&);
template void filter_in_place(const CountImage&, const CountImage&, const FilterWidths<float>&,
                              const FilterOptions&, FilteredPieces&, GuardCounts&);

}  // namespace spool
