// The two guides that window weights compare: the logarithm of a small feature-guided mean of the
// clamped samples (the pilot P), and the mean of the logarithms of the samples; each blurred to two
// pyramid levels s and 2 s, RGB: 12 channels. A scale whose taps stand 2^k pieces apart has levels
// 2^k times as coarse.
//
// The coarser level of the first scale follows the structure of the picture
// (directional_guides.h).
//
//   of the pilot       g = log b, b = max(G_s P, 0) + kPilotFloor L;  v = o((G_s PV / k) / b^2)
//   of the logarithms  g = G_s t;                                     v = o((G_s tv) / k)
//   o(v) = slack v + (small_slack - slack) min(v, small_noise^2 / mean samples of a piece)
//
// Noise that is small is underestimated by more than noise that is large, and what its distances
// may hide is a faint contrast.
// G_s: Gaussian of s pieces; PV, tv: variances of P and t; k = max(1, 2 pi s^2) is how much the
// blur takes off a noise that is correlated already. Levels beyond the second are blurs of the
// level before: G_2s is taken for G_s and a Gaussian of sqrt(3) s with taps s / (2 guide_sigma)
// apart. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include <algorithm>
#include <memory>

#include "lib/filters/twin_guides/directional_guides.h"
#include "lib/filters/twin_guides/feature_blend.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {

inline constexpr std::size_t kGuideChannels = 12;

// Takes the moments of the logarithms along.
GuideSources guide_sources(SampleMoments& moments, const FeatureImages& features);

// o above.
struct GuideSlack {
  float of_small, of_large, small;  // small: a variance
  float operator()(float v) const {
    return of_large * v + (of_small - of_large) * std::min(v, small);
  }
};

// The sources on the two levels of the finest scale, shared by all that begins with them.
struct GuideLevels {
  std::shared_ptr<const GuideSources> fine, coarse;
  GuideSlack slack;
};

GuideLevels guide_levels(const GuideSources& sources, const CountImage& n,
                         const RadianceScale& scale, const TwinGuidesOptions& options);

// Guides of one scale after the other, from the finest on. `finest.fine` may be missing where
// coarsen() comes before the first guides.
class GuidePyramid {
 public:
  GuidePyramid(GuideLevels finest, const RadianceScale& scale, const TwinGuidesOptions& options);
  int step() const { return step_; }  // between the taps of the scale, pieces
  void coarsen();
  // Value and variance of each channel in turn, of the pieces of a lattice. Made for a tile at a
  // time: the whole image's would take as much memory again as the levels.
  TilePlanes guides(const Lattice& lattice, const Rectangle& around) const;

 private:
  double scene_luminance_, guide_sigma_;
  int step_ = 1;
  GuideLevels levels_;  // blurred to step_ guide_sigma_ and twice that
};

}  // namespace spool
