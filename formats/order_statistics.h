// Does a series of numbers go anywhere?
#pragma once

#include <span>
#include <vector>

namespace spool::format {

// Kendall's rank correlation of the values with their places, in standard deviations of what
// exchangeable values have [Kendall38]; of 2048 of them, evenly spread, where there are more.
double order_score(std::span<const double> values);

// Their ranks less the mean rank, of square sum 1; all 0 where the values are equal, which share a
// rank.
std::vector<double> unit_ranks(std::span<const double> values);

struct Slope {
  double value = 0, error = 0;  // and its standard error
};
// Least squares; x and y have the same size, at least 3, and x is not constant.
Slope fit_slope(std::span<const double> x, std::span<const double> y);

}  // namespace spool::format
