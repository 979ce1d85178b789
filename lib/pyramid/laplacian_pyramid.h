// The undecimated Laplacian pyramid: coarse images f_0 .. f_K and the details d_0 .. d_{K-1}.
//
//   f_{k+1} = h *_D f_k,  d_k = f_k - prediction(f_{k+1}),  D = 2^k     [LiuZheng (1)-(4)]
//
// All images have the size of f_0, which may be any, 1 x 1 too. f_k is "the coarse value of size
// 2^k". With the sign of eq 1 corrected and the polyphase bookkeeping kept, eqs 1-3 are exactly
// this a-trous convolution [HolschneiderEtAl90]. f_k = d_k + prediction holds by construction, so
// collapse inverts build for every filter and border rule. Analysis is double; bits do not depend
// on threads, and update_pyramid gives the bits of a full rebuild. Slow twin:
// tests/reference/laplacian_pyramid_reference.h.
#pragma once

#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/core/rectangle.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

enum class LaplacianDetail {
  kCycleSpun,  // d_k = f_k - (g/2) * f_{k+1}: the mean of eq 4 over its four phases,
               // shift-invariant
  kPhase00,    // d_k = f_k - g * (f_{k+1} on phase (0, 0)): eq 4 as printed, shift-variant
};

struct PyramidOptions {
  WaveletFilter filter = WaveletFilter::k53;
  FilterRoles roles = FilterRoles::kLongAnalysis;
  LaplacianDetail detail = LaplacianDetail::kCycleSpun;
  int levels = 4;  // K, 0 .. 8
  Extension extension = Extension::kSymmetric;
};

OptionTable<PyramidOptions> pyramid_option_table();

template <class T>
struct PyramidImages {
  std::vector<Image<T>> coarse;  // f_0 .. f_K
  std::vector<Image<T>> detail;  // d_0 .. d_{K-1}
};
using Pyramid = PyramidImages<double>;

Pyramid build_pyramid(const Plane& f0, const PyramidOptions& options);

// build_pyramid into storage that exists; f0 may be pyramid.coarse[0] itself.
void rebuild_pyramid(Pyramid& pyramid, const Plane& f0, const PyramidOptions& options);

// f_0 from f_K and the details.
Plane collapse(const Pyramid& pyramid, const PyramidOptions& options);

// After pyramid.coarse[0] was changed inside `changed`: recomputes what depends on it and nothing
// else.
void update_pyramid(Pyramid& pyramid, const Rectangle& changed, const PyramidOptions& options);

// What that recomputes of an image of size `bounds`: K + 1 coarse boxes (the first is `changed`)
// and K detail ones.
void pyramid_influence(const Rectangle& changed, const Rectangle& bounds,
                       const PyramidOptions& options, std::vector<Rectangle>& coarse_boxes,
                       std::vector<Rectangle>& detail_boxes);

// The filters between f_k and f_{k+1}: h, and what the prediction of f_k convolves f_{k+1} with (at
// phase (0, 0) alone where the options say so).
Taps analysis_taps(const PyramidOptions& options, int k);
Taps prediction_taps(const PyramidOptions& options, int k);

// D = 2^k, between f_k and f_{k+1}.
int pyramid_dilation(int k);

}  // namespace spool
