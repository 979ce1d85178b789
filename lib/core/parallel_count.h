// Whole numbers summed by several threads: exact, so the same in any order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {

inline constexpr std::size_t kStretch = std::size_t{1} << 15;

// body(begin, end) for stretches of 0 .. n-1 that are disjoint and cover it, in parallel.
template <class Body>
void parallel_stretches(std::size_t n, Body&& body, std::size_t stretch = kStretch) {
  parallel_for((n + stretch - 1) / stretch,
               [&](std::size_t s) { body(s * stretch, std::min(n, (s + 1) * stretch)); });
}

// The sum of term(i), i = 0 .. n-1, of the type `Whole`. `term` is called once for each i, and may
// write what belongs to i.
template <class Whole, class Term>
Whole parallel_count(std::size_t n, Term&& term, std::size_t stretch = kStretch) {
  std::vector<Whole> partial((n + stretch - 1) / stretch, Whole{0});
  parallel_stretches(
      n,
      [&](std::size_t begin, std::size_t end) {
        Whole sum{0};
        for (std::size_t i = begin; i < end; ++i)
          sum += term(i);
        partial[begin / stretch] = sum;
      },
      stretch);
  return std::accumulate(partial.begin(), partial.end(), Whole{0});
}

// The same of the rows 0 .. height-1 of an image.
template <class Whole, class Term>
Whole parallel_count_rows(int height, Term&& term) {
  return parallel_count<Whole>(
      static_cast<std::size_t>(height), [&](std::size_t y) { return term(static_cast<int>(y)); },
      16);
}

}  // namespace spool
