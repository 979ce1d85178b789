// Slow twin of the Gaussian reconstruction: the two-dimensional sum, term by term.
#pragma once

#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"

namespace spool::reference {

// Sum over the pixels of share^power * image. A pixel's share is the sum of the weights that fall
// on it within the square of radius ceil(3 sigma), all of which sum to 1.
inline Plane gaussian_sum(const Plane& image, double sigma, int power) {
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  double total = 0.0;
  for (int i = -radius; i <= radius; ++i)
    total += sigma > 0.0 ? std::exp(-0.5 * i * i / (sigma * sigma)) : 1.0;
  Plane out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      Plane share(image.width(), image.height());
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          const double weight =
              sigma > 0.0 ? std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma)) : 1.0;
          share(extend_symmetric(x + dx, image.width()),
                extend_symmetric(y + dy, image.height())) += weight / (total * total);
        }
      }
      for (std::size_t p = 0; p < image.size(); ++p)
        out(x, y) += std::pow(share[p], power) * image[p];
    }
  }
  return out;
}

}  // namespace spool::reference
