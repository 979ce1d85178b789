#include "lib/pyramid/wavelet_filters.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"

namespace spool {
namespace {

// {centre, +-1, +-2, ...}
Taps symmetric(const std::vector<double>& half) {
  Taps taps;
  taps.first = -(static_cast<int>(half.size()) - 1);
  taps.values.assign(half.rbegin(), half.rend());
  taps.values.insert(taps.values.end(), half.begin() + 1, half.end());
  return taps;
}

// The orthogonal filter with three vanishing moments in closed form [Daubechies88], DC gain 1,
// placed so that its centroid is nearest offset 0.
Taps db3_analysis() {
  const double r = std::sqrt(10.0);
  const double t = std::sqrt(5.0 + 2.0 * r);
  Taps taps{
      -1,
      {1 + r + t, 5 + r + 3 * t, 10 - 2 * r + 2 * t, 10 - 2 * r - 2 * t, 5 + r - 3 * t, 1 + r - t}};
  for (double& value : taps.values)
    value /= 32.0;
  return taps;
}

FilterPair long_analysis_pair(WaveletFilter filter) {
  switch (filter) {
    case WaveletFilter::kHaar:
      return {{0, {0.5, 0.5}}, {-1, {1.0, 1.0}}};
    case WaveletFilter::k53:
      return {symmetric({6.0 / 8.0, 2.0 / 8.0, -1.0 / 8.0}), symmetric({1.0, 0.5})};
    case WaveletFilter::k97: {
      // The table has 15 digits and G sums to 2 - 6e-15; the exact sum keeps constants exact.
      const FilterPair pair{symmetric({0.602949018236360, 0.266864118442875, -0.078223266528990,
                                       -0.016864118442875, 0.026748757410810}),
                            symmetric({1.115087052456994, 0.591271763114250, -0.057543526228500,
                                       -0.091271763114250})};
      return {scaled(pair.analysis, 1.0 / tap_sum(pair.analysis)),
              scaled(pair.synthesis, 2.0 / tap_sum(pair.synthesis))};
    }
    case WaveletFilter::kDb3: {
      const Taps analysis = db3_analysis();
      return {analysis, scaled(mirrored(analysis), 2.0)};
    }
  }
  SPOOL_CHECK(false);
  return {};
}

}  // namespace

Taps mirrored(const Taps& taps) {
  Taps result{-taps.last(), taps.values};
  std::reverse(result.values.begin(), result.values.end());
  return result;
}

Taps scaled(const Taps& taps, double factor) {
  Taps result = taps;
  for (double& value : result.values)
    value *= factor;
  return result;
}

double tap_sum(const Taps& taps) {
  double sum = 0.0;
  for (const double tap : taps.values)
    sum += tap;
  return sum;
}

FilterPair filter_pair(WaveletFilter filter, FilterRoles roles) {
  FilterPair pair = long_analysis_pair(filter);
  if (roles == FilterRoles::kLongAnalysis) return pair;
  return {scaled(pair.synthesis, 0.5), scaled(pair.analysis, 2.0)};
}

FilterPair filter_pair_at(WaveletFilter filter, FilterRoles roles, int k) {
  FilterPair pair = filter_pair(filter, roles);
  if (k % 2 == 0) return pair;
  return {mirrored(pair.analysis), mirrored(pair.synthesis)};
}

Taps gaussian_taps(double sigma) {
  SPOOL_CHECK_GE(sigma, 0.0);
  if (sigma == 0.0) return {0, {1.0}};
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  Taps taps{-radius, {}};
  double sum = 0.0;
  for (int m = -radius; m <= radius; ++m) {
    taps.values.push_back(std::exp(-0.5 * (m / sigma) * (m / sigma)));
    sum += taps.values.back();
  }
  for (double& value : taps.values)
    value /= sum;
  return taps;
}

}  // namespace spool
