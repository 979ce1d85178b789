// Largest rounding errors of the library against the same computation in long double (64 bits of
// mantissa on x86-64, 2^11 times finer than double), as rows of a table.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/random.h"

namespace spool::bench {

using Fine = long double;

struct Row {
  std::string part, quantity, domain;
  double error = 0.0;  // in `unit`
  std::string unit;
};

inline constexpr double kUnit = std::numeric_limits<double>::epsilon();

// Largest |a - b| over the largest |b|, in roundings of that size.
template <class Values, class Exact>
double largest_error(const Values& values, const Exact& exact) {
  Fine difference = 0, size = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    difference = std::max(difference, std::abs(static_cast<Fine>(values[i]) - exact[i]));
    size = std::max(size, std::abs(exact[i]));
  }
  return static_cast<double>(difference / (size * kUnit));
}

inline Image<Fine> widened(const Plane& plane) {
  Image<Fine> wide(plane.width(), plane.height());
  for (std::size_t i = 0; i < wide.size(); ++i)
    wide[i] = plane[i];
  return wide;
}

inline double uniform(std::uint64_t seed, std::uint64_t i) {
  return unit_double(mix(seed, i));
}

struct NamedImage {
  std::string name;
  Plane image;
};

// Noise in [0, 1), noise of deviation 1e-2 around 1e6, and a firefly of 1e6.
std::vector<NamedImage> test_images(int width, int height);

void measure_statistics(std::vector<Row>& rows);
void measure_sums(std::vector<Row>& rows, std::uint64_t terms);
void measure_metrics(std::vector<Row>& rows);
void measure_pyramid(std::vector<Row>& rows);
void measure_bank(std::vector<Row>& rows);
void measure_sizes(std::vector<Row>& rows);
void measure_filter(std::vector<Row>& rows);

}  // namespace spool::bench
