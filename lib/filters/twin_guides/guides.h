// The two guides that window weights compare, on one tile: the logarithm of a small feature-guided
// mean of the clamped samples (the pilot P), and the mean of the logarithms of the samples; each
// blurred to two pyramid levels s, RGB: 12 channels.
//
//   of the pilot       g = log b, b = max(G_s P, 0) + kPilotFloor L;  v = slack (G_s PV / k) / b^2
//   of the logarithms  g = G_s t;                                     v = slack (G_s tv) / k
//
// G_s: Gaussian of s pieces; PV, tv: variances of P and t; k = max(1, 2 pi s^2) is how much the
// blur takes off a noise that is correlated already. Slow twin:
// tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/feature_blend.h"
#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {

inline constexpr std::size_t kGuideChannels = 12;

// `covered` holds the guides; it may reach beyond the image, where the nearest piece's stand.
// Planes: value and variance of each channel in turn.
TilePlanes guides_around(const Rectangle& covered, const SampleMoments& moments,
                         const FeatureImages& features, const RadianceScale& scale,
                         const TwinGuidesOptions& options);

}  // namespace spool
