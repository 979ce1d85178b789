#include "formats/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

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

std::vector<double> unit_ranks(std::span<const double> values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  const double middle = (static_cast<double>(values.size()) - 1) / 2;
  double squares = 0;
  for (size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && values[order[last]] == values[order[first]])
      ++last;
    const double rank = static_cast<double>(first + last - 1) / 2 - middle;
    for (size_t i = first; i < last; ++i)
      ranks[order[i]] = rank;
    squares += static_cast<double>(last - first) * rank * rank;
  }
  for (double& rank : ranks)
    rank /= squares > 0 ? std::sqrt(squares) : 1;
  return ranks;
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
