#include "lib/metrics/weighted_rows.h"

#include <cstddef>
#include <cstring>

#include "lib/core/eight_floats.h"

namespace spool {

namespace {

constexpr int kTogether = 32;  // sums that stay in registers; fewer would wait for one another

template <class Vector>
[[gnu::always_inline]] inline void add_rows_of(std::span<const double> taps,
                                               std::span<const double* const> from,
                                               double* __restrict to, int width) {
  typedef double Doubles __attribute__((vector_size(sizeof(Vector))));
  constexpr int kDoubles = kFloats<Vector> / 2, kParts = kTogether / kDoubles;
  int x = 0;
  for (; x + kTogether <= width; x += kTogether) {
    Doubles sums[kParts] = {}, row;
    for (std::size_t i = 0; i < taps.size(); ++i) {
      const double tap = taps[i];
#pragma GCC unroll 8
      for (int part = 0; part < kParts; ++part) {
        std::memcpy(&row, from[i] + x + part * kDoubles, sizeof(Doubles));
        sums[part] += tap * row;
      }
    }
    std::memcpy(to + x, sums, sizeof(sums));
  }
  for (; x < width; ++x) {
    double sum = 0.0;
    for (std::size_t i = 0; i < taps.size(); ++i)
      sum += taps[i] * from[i][x];
    to[x] = sum;
  }
}

SPOOL_VECTOR_WIDTHS(void add_rows_by_width(std::span<const double> taps,
                                           std::span<const double* const> from, double* to,
                                           int width),
                    add_rows_of<Vector>(taps, from, to, width))

}  // namespace

void add_rows(std::span<const double> taps, std::span<const double* const> from, double* to,
              int width) {
  add_rows_by_width(taps, from, to, width);
}

}  // namespace spool
