#include "lib/inference/half_spread.h"

#include <algorithm>
#include <map>

namespace spool {
namespace {

// Degrees of freedom of independent cells that the windows are worth: the trace of the weights'
// square, 1 + 4/4 + 4/16 a cell.
constexpr double kCellsPerFreedom = 2.25;

// Sum of squares over all windows of 2 x 2 cells, those that reach over the border too, / 4.
double window_squares(const HalfDifference& split) {
  const int columns = split.columns;
  const int rows = static_cast<int>(split.cells.size()) / columns;
  const auto cell = [&](int y, int x) {
    const bool inside = y >= 0 && y < rows && x >= 0 && x < columns;
    return inside ? split.cells[static_cast<std::size_t>(y * columns + x)] : 0.0;
  };
  double sum = 0.0;
  for (int y = -1; y < rows; ++y) {
    for (int x = -1; x < columns; ++x) {
      const double window = cell(y, x) + cell(y, x + 1) + cell(y + 1, x) + cell(y + 1, x + 1);
      sum += window * window / 4.0;
    }
  }
  return sum;
}

// By the kurtosis of the cells: n where n cells vary alike and normally, 1 where one varies alone.
double freedom_of(std::span<const HalfDifference> splits) {
  const double k = static_cast<double>(splits.size());
  double squares = 0.0, fourth = 0.0;
  for (std::size_t c = 0; c < splits.front().cells.size(); ++c) {
    double square = 0.0;
    for (const HalfDifference& split : splits)
      square += split.cells[c] * split.cells[c] / k;
    squares += square;
    fourth += square * square;
  }
  if (!(fourth > 0.0)) return 0.0;
  const double cells = (1.0 + 2.0 / k) * squares * squares / fourth - 2.0 / k;
  return std::max(1.0, cells / kCellsPerFreedom);
}

}  // namespace

HalfVariance half_variance(std::span<const HalfDifference> splits) {
  HalfVariance found;
  if (splits.empty()) return found;
  for (const HalfDifference& split : splits) {
    if (split.cells.size() != splits.front().cells.size()) return found;
  }
  for (const HalfDifference& split : splits)
    found.variance += 0.5 * window_squares(split) / static_cast<double>(splits.size());
  found.freedom = freedom_of(splits);
  return found;
}

std::vector<HalfDifference> difference_of(std::span<const HalfDifference> a, double first,
                                          std::span<const HalfDifference> b, double second) {
  std::vector<HalfDifference> found;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    if (a[k].columns != b[k].columns || a[k].cells.size() != b[k].cells.size()) return {};
    HalfDifference& split = found.emplace_back(HalfDifference{a[k].columns, a[k].cells, {}});
    for (std::size_t c = 0; c < split.cells.size(); ++c)
      split.cells[c] = first * a[k].cells[c] - second * b[k].cells[c];
  }
  return found;
}

TakenCounts varying_counts(std::span<const HalfDifference> splits) {
  std::map<int, long long> all;
  for (const HalfDifference& split : splits) {
    for (const auto& [samples, share] : split.varying)
      all[samples] += share;
  }
  return {all.begin(), all.end()};
}

}  // namespace spool
