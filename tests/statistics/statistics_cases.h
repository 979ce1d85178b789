// Pools with uneven counts for the tests of statistics.
#pragma once

#include <cmath>

#include "lib/core/random.h"
#include "lib/statistics/piece_statistics.h"
#include "tests/support/memory_pool.h"

namespace spool::test {

// Radiance of mixed sign and size; some pixels black, some constant, a few fireflies.
inline Rgb wild_radiance(int x, int y, int s) {
  const auto u = [&](int word) { return unit_double(mix(77, x, y, s, word)); };
  if ((x + y) % 11 == 0) return {0.0f, 0.0f, 0.0f};
  if ((x + y) % 11 == 1) return {0.25f, 0.5f, 1.0f};
  const double scale = u(3) < 0.01 ? 1e5 : 1.0;
  return {static_cast<float>(scale * (u(0) - 0.2)), static_cast<float>(scale * u(1)),
          static_cast<float>(1000.0 + 0.05 * u(2))};
}

// Counts 0 .. most, by hash.
inline CountImage uneven_counts(int width, int height, int most, std::uint64_t seed = 9) {
  CountImage n(width, height);
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] = static_cast<std::int32_t>(mix(seed, i) % static_cast<std::uint64_t>(most + 1));
  return n;
}

}  // namespace spool::test
