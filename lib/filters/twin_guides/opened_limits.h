// Light that every group of samples has is light before the filter, too: the clamp opens where
// independent samples agree.
//
//   r_k = mean over group k (agreed_light.h) of what is above T,   K = mean of what is not
//   a   = min over k of G_s r_k / G_s K,    s = clamp_sigma
//   o(v) = (v / heavy - 1/4) / (3/4) within 0 .. 1
//   T'  = T (1 + opening o(a) a)
//   h   = o(a / 2) max((1.7 - c) / 0.5, d - 1), both within 0 .. 1;   c, d: correlation and
//         density of event_places.h
//
// A firefly is in one group, so it opens nothing. Where one sample in thirty carries the light all
// groups lose alike, a tenth of what is kept and more; returned later (agreed_light.h) that light
// comes in blotches, and half of it stays lost. Elsewhere o is 0: what the clamp takes there is
// better lost. Noise is pooled (h) where a quarter of what is kept is lost, and where the samples
// above T fall anywhere alike, or within their places: beside a lamp out of focus, whose samples
// are no less rare, its noise blurred what is around it. Slow twin:
// tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

struct OpenedLimits {
  Plane limits;  // T' [y][x] of pixels, radiance
  Plane heavy;   // h [y][x] of pieces; empty where it is 0 everywhere
};

// `limits`: T.
OpenedLimits open_limits(Plane limits, const SamplePool& pool, const CountImage& n,
                         const TwinGuidesOptions& options);

}  // namespace spool
