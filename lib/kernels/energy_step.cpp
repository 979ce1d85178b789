#include "lib/kernels/energy_step.h"

#include <algorithm>
#include <cmath>

#include "lib/kernels/truncated_filter.h"

namespace spool {
namespace {

Plane restored(Plane out, const Plane& mean, const Taps& taps, double floor, double top) {
  Plane weight(out.width(), out.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!std::isfinite(out[i] + mean[i])) continue;  // weight 0
    const double bright = std::min(std::max(out[i], 0.0), top);
    weight[i] = bright * bright + floor * floor;
  }
  Plane share = truncated_sum(weight, taps);
  for (std::size_t i = 0; i < out.size(); ++i)
    share[i] = weight[i] > 0.0 ? (mean[i] - out[i]) / share[i] : 0.0;
  share = truncated_sum(share, taps);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (weight[i] > 0.0) out[i] += weight[i] * share[i];
  }
  return out;
}

}  // namespace

RgbImage restore_energy(RgbImage out, const RgbImage& mean, double unit,
                        const EnergyStepOptions& options, GuardCounts& guards) {
  SPOOL_CHECK(out[0].same_size(mean[0]));
  for (std::size_t i = 0; i < out[0].size(); ++i) {
    const double all = out[0][i] + mean[0][i] + out[1][i] + mean[1][i] + out[2][i] + mean[2][i];
    if (!std::isfinite(all)) guards.add(Guard::kEnergyNotFinite);
  }
  const Taps taps = four_sigma_taps(options.sigma);
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = restored(std::move(out[c]), mean[c], taps, options.floor * unit, options.top * unit);
  return out;
}

}  // namespace spool
