// Orders of numbers in which NaN has a place, the last one. A sort by `<` alone reads beyond its
// array where it meets a NaN.
#pragma once

#include <cmath>

namespace spool {

inline bool ascending(double a, double b) {
  return std::isnan(b) ? !std::isnan(a) : a < b;
}
inline bool descending(double a, double b) {
  return std::isnan(b) ? !std::isnan(a) : a > b;
}

}  // namespace spool
