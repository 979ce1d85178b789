// Slow twin of lib/metrics/structural_similarity: every window summed anew, two passes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "lib/core/image.h"

namespace spool::reference {

struct WindowSimilarity {
  double ssim, contrast_structure;
};

// Of the window of `size` (odd) centred at (x, y), which must fit.
inline WindowSimilarity similarity_at(const Plane& a, const Plane& b, int size, int x, int y) {
  const int r = size / 2;
  long double total = 0, mean_a = 0, mean_b = 0;
  const auto bell = [](int i) { return std::exp(-i * i / (2.0L * 1.5L * 1.5L)); };
  static const long double bells[] = {bell(0), bell(1), bell(2), bell(3), bell(4), bell(5)};
  const auto weight = [&](int i, int j) { return bells[std::abs(i)] * bells[std::abs(j)]; };
  for (int j = -r; j <= r; ++j) {
    for (int i = -r; i <= r; ++i) {
      total += weight(i, j);
      mean_a += weight(i, j) * a(x + i, y + j);
      mean_b += weight(i, j) * b(x + i, y + j);
    }
  }
  mean_a /= total, mean_b /= total;
  long double aa = 0, bb = 0, ab = 0;
  for (int j = -r; j <= r; ++j) {
    for (int i = -r; i <= r; ++i) {
      const long double da = a(x + i, y + j) - mean_a, db = b(x + i, y + j) - mean_b;
      aa += weight(i, j) * da * da / total;
      bb += weight(i, j) * db * db / total;
      ab += weight(i, j) * da * db / total;
    }
  }
  const long double c1 = 1e-4L, c2 = 9e-4L;
  const long double cs = (2 * ab + c2) / (aa + bb + c2);
  const long double l = (2 * mean_a * mean_b + c1) / (mean_a * mean_a + mean_b * mean_b + c1);
  return {static_cast<double>(cs * l), static_cast<double>(cs)};
}

// MS-SSIM with the weights of its first scales made to sum to 1.
inline double ms_ssim(Plane a, Plane b, int scales) {
  const double published[] = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
  double sum = 0, log_product = 0;
  for (int j = 0; j < scales; ++j)
    sum += published[j];
  for (int j = 0; j < scales; ++j) {
    const int size = 11, r = 5;
    long double mean = 0;
    int n = 0;
    for (int y = r; y < a.height() - r; ++y) {
      for (int x = r; x < a.width() - r; ++x) {
        const WindowSimilarity s = similarity_at(a, b, size, x, y);
        mean += j + 1 == scales ? s.ssim : s.contrast_structure;
        ++n;
      }
    }
    log_product += published[j] / sum * std::log(static_cast<double>(mean / n));
    Plane half_a(a.width() / 2, a.height() / 2), half_b = half_a;
    for (int y = 0; y < half_a.height(); ++y) {
      for (int x = 0; x < half_a.width(); ++x) {
        for (int k = 0; k < 4; ++k) {
          half_a(x, y) += a(2 * x + k % 2, 2 * y + k / 2) / 4;
          half_b(x, y) += b(2 * x + k % 2, 2 * y + k / 2) / 4;
        }
      }
    }
    a = half_a, b = half_b;
  }
  return std::exp(log_product);
}

}  // namespace spool::reference
