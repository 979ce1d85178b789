#include "lib/inference/half_spread.h"

#include <algorithm>
#include <map>

namespace spool {
namespace {

// Degrees of freedom of independent cells that the windows are worth: the trace of the weights'
// square, 1 + 4/4 + 4/16 a cell.
constexpr double kCellsPerFreedom = 2.25;

// Sum of squares over all windows of 2 x 2 cells, those that reach over the border too, / 4.
// `bordered` is scratch: the cells amid a row and a column of zeros on each side.
double window_squares(const HalfDifference& split, std::vector<double>& bordered) {
  const auto columns = static_cast<std::size_t>(split.columns);
  const std::size_t rows = split.cells.size() / columns, width = columns + 2;
  bordered.assign((rows + 2) * width, 0.0);
  for (std::size_t y = 0; y < rows; ++y)
    std::copy_n(&split.cells[y * columns], columns, &bordered[(y + 1) * width + 1]);
  double sum = 0.0;
  for (std::size_t y = 0; y <= rows; ++y) {
    const double* above = &bordered[y * width];
    const double* below = above + width;
    for (std::size_t x = 0; x <= columns; ++x) {
      const double window = above[x] + above[x + 1] + below[x] + below[x + 1];
      sum += window * window / 4.0;
    }
  }
  return sum;
}

// By the kurtosis of the cells: n where n cells vary alike and normally, 1 where one varies alone.
double freedom_of(std::span<const HalfDifference> splits) {
  const double k = static_cast<double>(splits.size());
  std::vector<double> of_cell(splits.front().cells.size());
  for (const HalfDifference& split : splits) {
    for (std::size_t c = 0; c < of_cell.size(); ++c)
      of_cell[c] += split.cells[c] * split.cells[c] / k;
  }
  double squares = 0.0, fourth = 0.0;
  for (const double square : of_cell) {
    squares += square;
    fourth += square * square;
  }
  if (!(fourth > 0.0)) return 0.0;
  const double cells = (1.0 + 2.0 / k) * squares * squares / fourth - 2.0 / k;
  return std::max(1.0, cells / kCellsPerFreedom);
}

}  // namespace

HalfSpread half_variance(std::span<const HalfDifference> splits) {
  HalfSpread found;
  if (splits.empty()) return found;
  for (const HalfDifference& split : splits) {
    if (split.cells.size() != splits.front().cells.size()) return found;
  }
  std::vector<double> bordered;
  for (const HalfDifference& split : splits)
    found.variance += 0.5 * window_squares(split, bordered) / static_cast<double>(splits.size());
  found.freedom = freedom_of(splits);
  return found;
}

std::vector<HalfDifference> difference_of(std::span<const HalfDifference> a, double first,
                                          std::span<const HalfDifference> b, double second) {
  std::vector<HalfDifference> found;
  auto other = b.begin();
  for (const HalfDifference& one : a) {
    while (other != b.end() && other->replicate < one.replicate)
      ++other;
    if (other == b.end() || other->replicate != one.replicate) continue;
    if (one.columns != other->columns || one.cells.size() != other->cells.size()) return {};
    HalfDifference& split =
        found.emplace_back(HalfDifference{one.columns, one.cells, {}, one.replicate});
    for (std::size_t c = 0; c < split.cells.size(); ++c)
      split.cells[c] = first * one.cells[c] - second * other->cells[c];
    ++other;
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
