// Separable filters whose window is cut at the border and renormalised there, unlike the symmetric
// extension of the pyramid: nothing outside the image is invented.
//
// Sums run over the taps in the order of their offsets, rows first; an output depends on its window
// alone. Slow twin: tests/reference/truncated_filter_reference.h.
#pragma once

#include <vector>

#include "lib/core/image.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

// sum over (m, n) inside the image of taps(m) taps(n) image(x - m, y - n).
Plane truncated_sum(const Plane& image, const Taps& taps);

// The same of an image of ones, row by row: the taps inside the image. From any thread.
class TapsInside {
 public:
  TapsInside(int width, int height, const Taps& taps);
  // The sums [x] of row y, which may lie in `memory`; rows whose window no border cuts share
  // theirs.
  const std::vector<double>& row(int y, std::vector<double>& memory) const;

 private:
  std::vector<double> sums(int first, int last) const;

  int height_;
  Taps taps_;
  std::vector<double> of_row_, whole_;
};

// truncated_sum / sum of the taps that lie inside.
Plane truncated_mean(const Plane& image, const Taps& taps);

// Variance of truncated_mean for independent pixels of variance v: sum of squares(m) squares(n) v,
// divided by the squared sum of the taps inside. `squares` are the taps' squares, or what replaces
// them where a pixel consists of finer cells; same offsets as `taps`.
Plane truncated_variance(const Plane& v, const Taps& taps, const Taps& squares);

Taps squared_taps(const Taps& taps);
Taps convolved_taps(const Taps& a, const Taps& b);
Taps peak_normalised(const Taps& taps);  // divided by the tap at offset 0

// Gaussian cut at radius floor(3 sigma), sum 1 [RousselleKnausZwicker11].
Taps floor_gaussian_taps(double sigma);

// Gaussian cut at radius floor(4 sigma + 1/2), sum 1: wide enough that what is cut off does not
// show.
Taps four_sigma_taps(double sigma);

// g(d) = max(0, exp(-2 d^2) - exp(-8)) at d = -1, 0, 1 pixels, sum 1: the small pixel filter.
Taps pixel_filter_taps();

}  // namespace spool
