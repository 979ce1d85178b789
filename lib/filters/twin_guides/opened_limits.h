// Light that every group of samples has is light before the filter, too: the clamp and the robust
// limit open where independent samples agree.
//
//   r_k = mean over group k (agreed_light.h) of what is above T,   K = mean of what is not
//   T'  = T (1 + opening min over k of G_s r_k / G_s K),           s = clamp_sigma
//   tl' = max(tl, log(max(G_s luminance(C), 0) / 2 + 0.10 L))
//
// A firefly is in one group, so it opens nothing. Where one sample in thirty carries the light all
// groups lose alike; returned later (agreed_light.h) that light comes in blotches, and half of it
// stays lost. The mean of logarithms lies far below the mean there, and a limit made of it would
// take the same light again. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

// `limits`: T [y][x] of pixels, radiance. opening >= 0; sigma in pixels.
Plane open_limits(Plane limits, const SamplePool& pool, const CountImage& n, double sigma,
                  double opening);

// Raises the mean logarithms that the robust limit is made of; sigma in pieces.
void raise_logarithms(SampleMoments& moments, double sigma, const RadianceScale& scale);

}  // namespace spool
