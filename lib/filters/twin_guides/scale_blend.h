// One picture of all scales: from the coarsest on, each finer scale adds the detail that it shows
// beyond its noise.
//
//   d_k = X_k - X_{k+1},   e_k = E_k - E_{k+1}             picture and noise of the detail
//   D, N, V = << d_k^2 >>, << e_k^2 >>, << e_k E_{k+1} >>  relative to picture^2 + (0.1 L)^2;
//             N of such places from a pool that grows first (grown_variance.h)
//   a_k = min(1, max(0, D - slack (N + V)) / D)
//   out_k = out_{k+1} + a_k (X_k - out_{k+1}),             out of the coarsest scale: X itself
//
// D - N is what the bias of the coarser scale comes to, N + V what its lower noise saves: the
// balance of variance and bias by which the paper's method picks a size, for a share in place of a
// choice. A few draws of noise say little of its size, so << >> is a mean over some hundred pieces,
// under weights of the guides, so that lines and corners are judged by their like and not by the
// wall beside them: windows of radius 2 with taps 2, 4 and 8 pieces apart, one after the other.
// Where few samples carry the light (NoisePool::share) hardly any finer detail is added, and
// neighbours of a coarse scale, whose windows share no tap, would show as a grid: there the picture
// is the mean over a window of radius 3 under weights of the guides and ten times those of the
// features. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/guides.h"
#include "lib/filters/twin_guides/scale_inputs.h"

namespace spool {

// `scales`: the finest first, at least one.
FloatRgb blend_scales(const std::vector<ScaleImages>& scales, const GuideSources& sources,
                      const FeatureImages& clean, const NoisePool& noise_pool,
                      const RadianceScale& scale, const TwinGuidesOptions& options);

}  // namespace spool
