// Slow twin of the filter `clamped`: every pixel's samples in a list, whole pixels only.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool::reference {

inline RgbImage clamped(const SamplePool& pool, const CountImage& n, double factor) {
  const int width = n.width(), height = n.height();
  RgbImage mean = make_rgb(width, height), image = make_rgb(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < n(x, y); ++s) {
        for (std::size_t c = 0; c < 3; ++c)
          mean[c](x, y) += static_cast<double>(pool.sample(x, y, s)[c]) / n(x, y);
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double around = 0.0;
      int neighbours = 0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
          if (u == x && v == y) continue;
          around += 0.2126 * mean[0](u, v) + 0.7152 * mean[1](u, v) + 0.0722 * mean[2](u, v);
          ++neighbours;
        }
      }
      const double limit = neighbours > 0 ? std::max(0.0, factor * around / neighbours) : 1e300;
      int largest = 0;
      std::vector<double> light;
      for (int s = 0; s < n(x, y); ++s) {
        const Rgb v = pool.sample(x, y, s);
        light.push_back(0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]);
        if (light.back() > light[static_cast<std::size_t>(largest)]) largest = s;
      }
      for (int s = 0; s < n(x, y); ++s) {
        const double l = light[static_cast<std::size_t>(s)];
        const double scale = s == largest && l > limit ? limit / l : 1.0;
        for (std::size_t c = 0; c < 3; ++c)
          image[c](x, y) += scale * pool.sample(x, y, s)[c] / n(x, y);
      }
    }
  }
  return image;
}

}  // namespace spool::reference
