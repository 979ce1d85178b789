// The decimated two-dimensional wavelet transform, in place, square decomposition.
//
// Level after level the scale coefficients of the upper left corner are split along x, then y, into
// low (first half) and high (second half): after L levels band (i, j) of level l lies at
// [i n / 2^l, ...) x [j m / 2^l, ...). The 9-7 wavelet, nearly orthonormal
// [CohenDaubechiesFeauveau92]: h0 = sqrt 2 H, g0 = G / sqrt 2, high-pass h1(n) = (-1)^n g0(n) about
// the odd samples, g1(n) = (-1)^n h0(n). Borders: whole-sample symmetry, which the odd filters
// carry through decimation exactly. Perfect reconstruction to 1e-12 of the largest value.
#pragma once

#include "lib/core/image.h"

namespace spool {

enum class TransformOf {
  kValues,
  kVariances,  // squared filters: variances of the coefficients of independent pixels
};

// Half-sample symmetric padding to multiples of 2^levels.
Plane padded_for_transform(const Plane& image, int levels);

// Sides must be multiples of 2^levels.
void forward_transform(Plane& image, int levels, TransformOf of);
void inverse_transform(Plane& image, int levels);

// Of both transforms of values the transposed matrices: a row of a matrix, that is which pixels
// make a coefficient or which coefficients make a pixel, is its transpose times what is 1 there and
// 0 elsewhere.
void transposed_forward_transform(Plane& image, int levels);
void transposed_inverse_transform(Plane& image, int levels);

}  // namespace spool
