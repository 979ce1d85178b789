// Gives an image the energy of another: what a filter lost against an unbiased mean goes where it
// costs the least relative error.
//
//   w    = min(max(out, 0), top U)^2 + (floor U)^2          per channel; U: the scene's luminance
//   out' = out + w G_sigma * [ (M - out) / (G_sigma * w) ]
//
// G is a Gaussian with nothing beyond the border, hence its own adjoint, so the sum of out' is the
// sum of M up to rounding, in each channel, whatever w is. The light moves by some sigma: it
// returns to its neighbourhood, not to its pixel. A wide sigma adds little noise (M is a noisy
// image), a small floor leaves dark places alone (decision 121); a low top keeps lamps from taking
// light that was lost elsewhere (decision 159). Where much light was lost or won out' may be
// negative. A pixel that is not finite in either image keeps its value and takes no
// part. Slow twin: tests/reference/energy_step_reference.h.
#pragma once

#include <limits>

#include "lib/core/guards.h"
#include "lib/core/image.h"

namespace spool {

struct EnergyStepOptions {
  double sigma = 128.0;                                  // pixels
  double floor = 0.2;                                    // in units of the scene's luminance
  double top = std::numeric_limits<double>::infinity();  // the same
};

// `mean`: M, of the size of `out`; `unit`: U > 0, radiance units (scene_luminance.h).
RgbImage restore_energy(RgbImage out, const RgbImage& mean, double unit,
                        const EnergyStepOptions& options, GuardCounts& guards);

}  // namespace spool
