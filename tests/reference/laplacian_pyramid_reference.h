// Slow twin of lib/pyramid/laplacian_pyramid.h: f_{k+1} and d_k as double sums at every pixel.
//
// It follows the definitions, not the fast code: the phase (0, 0) detail multiplies by the mask
// m_k(x, y) = [floor(x/D) even][floor(y/D) even].
#pragma once

#include "lib/pyramid/laplacian_pyramid.h"
#include "tests/reference/convolution_reference.h"

namespace spool::reference {

// Eqs 1-3 as the text writes them, on every polyphase component of step `dilation`: four shifted
// copies, each filtered and decimated, then interleaved. direction = 1 is the corrected sign of eq
// 1, f^{ij}(x, y) = f(x + i, y + j), which is the convolution bit for bit; -1 is eq 1 as printed.
inline Plane eqs_1_to_3(const Plane& in, const Taps& analysis, int dilation, int direction,
                        Extension extension) {
  // The index that f^{ij}(2 u - m) of eqs 1 and 2 reads for output coordinate x, where x is element
  // 2 u + i of polyphase component x mod D.
  const auto source = [&](int at, int m, int n) {
    const int component = at % dilation, element = at / dilation;
    const int i = element % 2, u = (element - i) / 2;
    return extend((2 * u - m + direction * i) * dilation + component, n, extension);
  };
  const auto convolved = [&](auto&& term) {
    double sum = 0.0;
    for (std::size_t i = 0; i < analysis.values.size(); ++i) {
      const double next = analysis.values[i] * term(analysis.first + static_cast<int>(i));
      sum = i == 0 ? next : sum + next;
    }
    return sum;
  };
  Plane out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      out(x, y) = convolved([&](int b) {
        const int from_y = source(y, b, in.height());
        return convolved([&](int a) { return in(source(x, a, in.width()), from_y); });
      });
    }
  }
  return out;
}

inline Plane coarse_of(const Plane& fine, const PyramidOptions& options, int k) {
  const Taps h = filter_pair_at(options.filter, options.roles, k).analysis;
  const int dilation = pyramid_dilation(k);
  Plane out(fine.width(), fine.height());
  for (int y = 0; y < fine.height(); ++y) {
    for (int x = 0; x < fine.width(); ++x) {
      out(x, y) = convolve_at(fine, h, dilation, options.extension, x, y);
    }
  }
  return out;
}

inline Plane prediction_of(const Plane& coarse, const PyramidOptions& options, int k) {
  const Taps g = filter_pair_at(options.filter, options.roles, k).synthesis;
  const int dilation = pyramid_dilation(k);
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
