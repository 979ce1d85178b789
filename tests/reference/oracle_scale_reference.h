// Slow twin of lib/filters/oracle_scale.h.
#pragma once

#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"

namespace spool::reference {

struct OracleScales {
  std::vector<RgbImage> candidates;  // [scale]
  std::vector<Plane> error;          // [scale] blurred
};

inline OracleScales oracle_scale(const RgbImage& mean, const RgbImage& truth, int scales,
                                 double smoothing) {
  const int width = mean[0].width(), height = mean[0].height();
  OracleScales result;
  for (int s = 0; s <= scales; ++s) {
    RgbImage candidate = mean;
    Plane squared(width, height);
    const double sigma = std::pow(2.0, (s - 2) / 2.0);
    const int reach = s == 0 ? 0 : static_cast<int>(std::floor(3.0 * sigma));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0.0, weights = 0.0;
          for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
              if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
              const double w = s == 0 ? 1.0 : std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
              sum += w * mean[c](x + dx, y + dy);
              weights += w;
            }
          }
          candidate[c](x, y) = sum / weights;
          squared(x, y) += std::pow(candidate[c](x, y) - truth[c](x, y), 2) / 3.0;
        }
      }
    }
    Plane error = squared;
    if (smoothing > 0.0) {
      const int radius = static_cast<int>(std::ceil(3.0 * smoothing));
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          double sum = 0.0, weights = 0.0;
          for (int dy = -radius; dy <= radius; ++dy) {
            for (int dx = -radius; dx <= radius; ++dx) {
              const double w = std::exp(-(dx * dx + dy * dy) / (2 * smoothing * smoothing));
              sum += w * squared(extend_symmetric(x + dx, width), extend_symmetric(y + dy, height));
              weights += w;
            }
          }
          error(x, y) = sum / weights;
        }
      }
    }
    result.candidates.push_back(candidate);
    result.error.push_back(error);
  }
  return result;
}

}  // namespace spool::reference
