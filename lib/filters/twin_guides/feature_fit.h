// Features cleaned by themselves, on one tile: a line through the features of the pieces around
// that look alike, and its value at the piece.
//
//   e(p, q) = max(0, gain * mean over the patch and the channels of
//                    ((f_p - f_q)^2 - slack (v_p + min(v_p, v_q))) / (v_p + v_q + tau))
//   w       = max(0, exp(-e - |p - q|^2 / (2 sigma^2)) - exp(-8)),    |dx|, |dy| <= radius
//   f_q     ~ F + a dx + b dy    by least squares under w; `ridge` on a and b, dx and dy in radii
//   FV      = sum w^2 v / (sum w)^2
//
// The patch moves p and q together; p stays inside the image, q is clamped to it. q runs over the
// window inside the image. A surface out of focus has ramps where it had edges; a line follows
// them where a mean flattens them, so distances may forgive more noise (slack). Distances less
// their noise are those of [RousselleKnausZwicker12]; the mean comes before the floor at 0, so
// that the noise of nine pairs and all channels cancels in it. Slow twin:
// tests/reference/feature_fit_reference.h.
#pragma once

#include "lib/filters/twin_guides/feature_blend.h"

namespace spool {

struct FeatureFitOptions {
  float tau = 1e-3f, slack = 1.5f, gain = 3.0f;
  int patch = 1;  // radius
  int radius = 5;
  double sigma = 4.0;
  float ridge = 0.01f;
};

// At least one channel.
Blend feature_fit(const Rectangle& tile, const FeatureImages& features,
                  const FeatureFitOptions& options);

}  // namespace spool
