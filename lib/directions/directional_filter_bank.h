// The undecimated directional filter bank: 2^l bands of an image, one per wedge of frequency
// angles.
//
// A split stage with integer vectors p and q is the zero-phase operator with frequency response
// B(w) = sigma(p.w) sigma(q.w) ~ sign(p.w) sign(q.w),
//
//   (Bx)(n) = - sum_a sum_b tap(a) tap(b) x(ext(n - (a + 1/2) p - (b + 1/2) q))
//   y+ = (x + Bx) / 2,  y- = (x - Bx) / 2
//
// and a tree of l stages makes the wedges of the quincunx tree [CunhaZhouDo06] without resampling:
// borders at slopes 0, 1/2, 1, 2, infinity. Bands are signed, have the size of the image, are
// ordered by frequency angle (degrees from +x towards +y, modulo 180) and sum to the image. A
// constant has no direction: each band gets 1/2^l of it. The extension applies to x at the end of
// both sums, not to the intermediate one: so mirroring or transposing an image mirrors or
// transposes its bands up to the border. The reach of one stage is (2J - 1) D pieces; it may exceed
// the image.
//
// T is double or float. Bits do not depend on threads.
// Slow twin: tests/reference/directional_filter_bank_reference.h.
#pragma once

#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/directions/sign_filter.h"

namespace spool {

struct BankOptions {
  int levels = 3;    // l, 0 .. 3
  int dilation = 1;  // D: every vector is multiplied by it
  SignTaps taps = SignTaps::kPkva12;
  Extension extension = Extension::kSymmetric;
};

OptionTable<BankOptions> bank_option_table();  // all but dilation and extension

// D for the detail d_k: max(1, 2^{k-1}). The 2^k of a decimated tree would put the upper edge of
// d_k's spectrum on the zero of sigma.
int detail_dilation(int k);

int band_count(const BankOptions& options);

template <class T>
std::vector<Image<T>> directional_bands(const Image<T>& image, const BankOptions& options);

// The same into storage that exists.
template <class T>
void directional_bands(const Image<T>& image, const BankOptions& options,
                       std::vector<Image<T>>& bands);

}  // namespace spool
