#include "lib/metrics/weighted_rows.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "lib/core/vector_clones.h"

namespace spool {

// Sixteen sums at a time stay in registers.
SPOOL_VECTOR_CLONES void add_rows(std::span<const double> taps, std::span<const double* const> from,
                                  double* to, int width) {
  constexpr int kTogether = 16;
  int x = 0;
  for (; x + kTogether <= width; x += kTogether) {
    std::array<double, kTogether> sums{};
    for (std::size_t i = 0; i < taps.size(); ++i)
      for (std::size_t k = 0; k < kTogether; ++k)
        sums[k] += taps[i] * from[i][x + static_cast<int>(k)];
    std::copy_n(sums.data(), kTogether, to + x);
  }
  for (; x < width; ++x) {
    double sum = 0.0;
    for (std::size_t i = 0; i < taps.size(); ++i)
      sum += taps[i] * from[i][x];
    to[x] = sum;
  }
}

}  // namespace spool
