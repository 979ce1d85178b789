// Sums whose order is fixed: chunks of 4096 in index order, chunk sums combined pairwise.
//
// Every sum that decides something is taken this way, so its bits depend neither on threads nor on
// tiling. Error bound: (4096 + log2(n / 4096)) * 2^-53 relative to the sum of absolute values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {

inline constexpr std::size_t kSumChunk = 4096;

namespace detail {
inline double combine_pairwise(const double* values, std::size_t n) {
  if (n == 0) return 0.0;
  if (n == 1) return values[0];
  const std::size_t half = n / 2;
  return combine_pairwise(values, half) + combine_pairwise(values + half, n - half);
}
}  // namespace detail

// Sum of term(i), i = 0 .. n-1. `term` must be a pure function of i.
template <class Term>
double pairwise_sum(std::size_t n, Term&& term) {
  const std::size_t chunks = (n + kSumChunk - 1) / kSumChunk;
  std::vector<double> partial(chunks, 0.0);
  parallel_for(chunks, [&](std::size_t c) {
    const std::size_t end = std::min(n, (c + 1) * kSumChunk);
    double sum = 0.0;
    for (std::size_t i = c * kSumChunk; i < end; ++i)
      sum += term(i);
    partial[c] = sum;
  });
  return detail::combine_pairwise(partial.data(), partial.size());
}

}  // namespace spool
