// The one-dimensional filter pairs of the pyramid: analysis H (DC gain 1) and synthesis G (DC gain
// 2).
//
// Both are written as (h * f)(x) = sum_m h(m) f(x - m). Every pair is biorthogonal under decimation
// by two, down(h * (g * up(c))) = c [DoVetterli03], to 2e-14. 5-3, 9-7 [CohenDaubechiesFeauveau92]
// and db3 [Daubechies88] have negative taps: a coarse value can be negative although every sample
// is positive, so nothing may divide by one or take its logarithm without a guard.
#pragma once

#include <vector>

namespace spool {

enum class WaveletFilter { kHaar, k53, k97, kDb3 };
enum class FilterRoles {
  kLongAnalysis,  // the longer filter analyses (contourlet convention)
  kSwapped,       // H = G / 2 and G = 2 H of the above
};

// values[i] is the tap at offset first + i.
struct Taps {
  int first = 0;
  std::vector<double> values;

  int last() const { return first + static_cast<int>(values.size()) - 1; }
};

struct FilterPair {
  Taps analysis;   // H, sums to 1
  Taps synthesis;  // G, sums to 2
};

FilterPair filter_pair(WaveletFilter filter, FilterRoles roles = FilterRoles::kLongAnalysis);

// The pair used between f_k and f_{k+1}, k = 0, 1, ... At odd k the offsets are mirrored, so that
// filters of even length stay centred on the average.
FilterPair filter_pair_at(WaveletFilter filter, FilterRoles roles, int k);

Taps mirrored(const Taps& taps);  // offset m -> -m
Taps scaled(const Taps& taps, double factor);
double tap_sum(const Taps& taps);

// Gaussian of standard deviation sigma >= 0, cut at radius ceil(3 sigma), normalised to sum 1.
Taps gaussian_taps(double sigma);

}  // namespace spool
