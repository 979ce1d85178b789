#include "formats/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spool::format {
namespace {

constexpr size_t kMostRanked = 2048;

}  // namespace

double order_score(std::span<const double> values) {
  const size_t step = values.size() / kMostRanked + 1;
  double score = 0, n = 0;
  for (size_t i = 0; i < values.size(); i += step, ++n)
    for (size_t j = i + step; j < values.size(); j += step)
      score += (values[j] > values[i]) - (values[j] < values[i]);
  return n < 2 ? 0 : 3 * score / std::sqrt(n * (n - 1) * (2 * n + 5) / 2);
}

Slope fit_slope(std::span<const double> x, std::span<const double> y) {
  double n = 0, mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    n += 1;
    const double dx = x[i] - mean_x, dy = y[i] - mean_y;
    mean_x += dx / n;
    mean_y += dy / n;
    xx += dx * (x[i] - mean_x);
    xy += dx * (y[i] - mean_y);
    yy += dy * (y[i] - mean_y);
  }
  const double slope = xy / xx, rest = std::max(yy - slope * xy, 0.0) / (n - 2);
  return {slope, std::sqrt(rest / xx)};
}

}  // namespace spool::format
