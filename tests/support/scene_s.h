// Scene S: an analytic grey picture with most of what adaptive sampling meets - a gradient, a
// slanted edge, a disc, a soft shadow, a blurred checker, a streak, a black corner, and fireflies
// if wanted. Independent samples, so any number of them can serve as the reference.
#pragma once

#include <cmath>
#include <cstdint>

#include "lib/core/image.h"
#include "lib/core/random.h"
#include "tests/support/memory_pool.h"

namespace spool::test {

// Sample s of pixel (x, y) of a picture with n x n pixels; `seed` names an independent stream.
inline double scene_s_sample(int n, int x, int y, std::uint64_t s, std::uint64_t seed,
                             bool fireflies) {
  const auto random = [&](std::uint64_t lane) { return unit_double(mix(seed, x, y, s, lane)); };
  const double side = n, px = x + random(0), py = y + random(1), t = random(2), q = random(3);
  double value = 0.25 + 0.25 * px / side;
  if (px * std::cos(0.6) + py * std::sin(0.6) < 0.42 * side) value = 0.8 * value + 0.35;
  if (std::hypot(px - 0.70 * side, py - 0.30 * side) < 0.14 * side) value = 0.95;
  if (px > 0.35 * side && py > 0.45 * side) {
    const double visible = std::min(std::max((py - 0.45 * side) / (0.35 * side), 0.0), 1.0);
    value *= 0.25 + (t < visible ? 0.75 : 0.0);
  }
  if (px < 0.35 * side && py > 0.55 * side) {
    const double cells =
        std::floor((px + (t - 0.5) * 14) / 8) + std::floor((py + (q - 0.5) * 14) / 8);
    value = std::fmod(std::abs(cells), 2.0) == 1.0 ? 0.85 : 0.15;
  }
  if (std::abs(py - 0.15 * side + 0.35 * (px - 0.5 * side)) < 5 && t < 0.5) value = 1.2;
  if (px > 0.8 * side && py > 0.85 * side) value = 0.0;
  if (fireflies && px > 0.5 * side && px < 0.75 * side && py > 0.75 * side && py < 0.95 * side &&
      q < 0.004) {
    value += 25.0;
  }
  return value;
}

inline SamplePool scene_s_pool(int n, int spp, std::uint64_t seed, bool fireflies = false,
                               double exposure = 1.0) {
  return memory_pool(n, n, spp, [&](int x, int y, int s) {
    const auto v = static_cast<float>(exposure * scene_s_sample(n, x, y, s, seed, fireflies));
    return Rgb{v, v, v};
  });
}

// Mean of `count` samples that no pool of another seed contains.
inline Plane scene_s_reference(int n, int count, std::uint64_t seed, bool fireflies = false) {
  Plane mean(n, n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      double sum = 0.0;
      for (int s = 0; s < count; ++s)
        sum += scene_s_sample(n, x, y, static_cast<std::uint64_t>(s), ~seed, fireflies);
      mean(x, y) = sum / count;
    }
  }
  return mean;
}

inline double mean_squared_error(const Plane& image, const Plane& reference) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i)
    sum += (image[i] - reference[i]) * (image[i] - reference[i]);
  return sum / static_cast<double>(image.size());
}

}  // namespace spool::test
