// Slow twin of lib/kernels/event_places.h: one pair of groups after the other.
#pragma once

#include <numbers>
#include <vector>

#include "tests/reference/blur_reference.h"

namespace spool::reference {

struct EventPlaces {
  Plane correlation, density;
};

inline EventPlaces event_places(const std::vector<Plane>& groups, double near, double far,
                                double m) {
  const double pi = std::numbers::pi;
  const double by_chance = 10.0 / (2.0 * pi * far * far) / (4.0 * pi * near * near) / (m * m);
  Plane pairs(groups[0].width(), groups[0].height()), anywhere = pairs, close = pairs, all = pairs;
  for (std::size_t j = 0; j < groups.size(); ++j) {
    const Plane a = blur(groups[j], near), c = blur(groups[j], far);
    for (std::size_t i = 0; i < pairs.size(); ++i)
      close[i] += a[i], all[i] += c[i];
    for (std::size_t k = 0; k < groups.size(); ++k) {
      if (j == k) continue;
      const Plane b = blur(groups[k], near), d = blur(groups[k], far);
      for (std::size_t i = 0; i < pairs.size(); ++i)
        pairs[i] += a[i] * b[i], anywhere[i] += c[i] * d[i];
    }
  }
  pairs = blur(pairs, far);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = (pairs[i] + by_chance) / (anywhere[i] + by_chance);
    close[i] = all[i] > 0.0 ? close[i] / all[i] : 0.0;
  }
  return {pairs, close};
}

}  // namespace spool::reference
