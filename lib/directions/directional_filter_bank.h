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

#include <span>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/directions/sign_filter.h"

namespace spool {

enum class ChannelPair {
  kComplementary,
  kLadder,  // y- = x - B y+ [PhoongKimVaidyanathanAnsari95]: x = y- + B y+, energies uneven
};
enum class BankKind {
  kNonsub,    // the tree above
  kFftWedge,  // cos^2 wedges in the frequency plane: a cross-check, see fourier_wedges.h
  kNone,      // one band, the image itself
};

struct BankOptions {
  int levels = 3;    // l, 0 .. 3
  int dilation = 1;  // D: every vector is multiplied by it
  SignTaps taps = SignTaps::kPkva12;
  ChannelPair pair = ChannelPair::kComplementary;
  BankKind kind = BankKind::kNonsub;
  Extension extension = Extension::kSymmetric;  // kClamp not with kFftWedge
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

// Borders between the wedges in degrees, ascending in [0, 180): wedge i of 2^l lies between border
// i and i + 1 (of l = 1: 135 .. 45 and 45 .. 135).
std::vector<double> band_borders(int levels);

// Mid angles of the wedges in frequency, degrees in [0, 180); and the spatial direction along which
// such an image is constant, frequency angle + 90 modulo 180. Indexed by band.
std::vector<double> band_frequency_angles(int levels);
std::vector<double> band_tangents(int levels);

// The frequency response of each band of a nonsub, complementary bank: real, on a grid of n x n
// frequencies w = 2 pi (i, j) / n.
class BankResponse {
 public:
  BankResponse(const BankOptions& options, int n);
  // bands[b] at frequency (i, j), 0 <= i, j < n.
  void at(int i, int j, std::span<double> bands) const;

 private:
  double split(int px, int py, int qx, int qy, int i, int j) const;  // sigma(p.w) sigma(q.w)

  int levels_ = 0, n_ = 0, dilation_ = 1;
  std::vector<double> sigma_;  // sigma(2 pi m / n), m < 2 n
};

}  // namespace spool
