// Slow twin of lib/pyramid/laplacian_pyramid.h: f_{k+1} and d_k as double sums at every pixel.
//
// It follows the definitions, not the fast code: the literal sign is a shifted convolution, and the
// phase (0, 0) detail multiplies by the mask m_k(x, y) = [floor(x/D) even][floor(y/D) even].
#pragma once

#include "lib/pyramid/laplacian_pyramid.h"
#include "tests/reference/convolution_reference.h"

namespace spool::reference {

inline Plane coarse_of(const Plane& fine, const PyramidOptions& options, int k) {
  const Taps h = filter_pair_at(options.filter, options.roles, options.even_align, k).analysis;
  const int dilation = pyramid_dilation(options, k);
  Plane out(fine.width(), fine.height());
  for (int y = 0; y < fine.height(); ++y) {
    for (int x = 0; x < fine.width(); ++x) {
      int from_x = x, from_y = y;
      if (options.sign == LaplacianSign::kLiteral) {
        from_x -= 2 * (x / dilation % 2) * dilation;
        from_y -= 2 * (y / dilation % 2) * dilation;
      }
      out(x, y) = convolve_at(fine, h, dilation, options.extension, from_x, from_y);
    }
  }
  return out;
}

inline Plane prediction_of(const Plane& coarse, const PyramidOptions& options, int k) {
  const Taps g = filter_pair_at(options.filter, options.roles, options.even_align, k).synthesis;
  const int dilation = pyramid_dilation(options, k);
  if (options.detail == LaplacianDetail::kAtrousDiff) return coarse;
  if (options.detail == LaplacianDetail::kCycleSpun) {
    return reference::convolve(coarse, scaled(g, 0.5), dilation, options.extension);
  }
  Plane masked = coarse;
  for (int y = 0; y < coarse.height(); ++y) {
    for (int x = 0; x < coarse.width(); ++x) {
      if (x / dilation % 2 != 0 || y / dilation % 2 != 0) masked(x, y) = 0.0;
    }
  }
  return reference::convolve(masked, g, dilation, options.extension);
}

inline Pyramid build_pyramid(const Plane& f0, const PyramidOptions& options) {
  Pyramid pyramid;
  pyramid.coarse.push_back(f0);
  for (int k = 0; k < options.levels; ++k) {
    const Plane& fine = pyramid.coarse.back();
    Plane coarse = coarse_of(fine, options, k);
    Plane detail = prediction_of(coarse, options, k);
    for (std::size_t i = 0; i < detail.size(); ++i)
      detail[i] = fine[i] - detail[i];
    pyramid.coarse.push_back(coarse);
    pyramid.detail.push_back(detail);
  }
  return pyramid;
}

}  // namespace spool::reference
