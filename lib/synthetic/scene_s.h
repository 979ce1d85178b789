// Scene S: the standard analytic test picture, with a piece of everything that is hard to sample.
//
// Gradient, slanted edge, disc, soft shadow (visibility is a coin flip), out-of-focus checker
// (jittered by up to 7 pixels), thin streak blurred along its direction, black corner, and
// optionally fireflies. Grey. Expectation and variance follow in closed form at every position and
// by pixel_quadrature.h over the pixel.
#pragma once

#include "lib/synthetic/analytic_scene.h"

namespace spool {

struct SceneSOptions {
  bool fireflies = false;
  double firefly_odds = 0.004;  // of a sample inside the firefly patch
  double firefly_value = 25.0;  // added to its radiance
};

AnalyticScene scene_s(int width, int height, const SceneSOptions& options = {});

// A recording of it in memory with film positions and the exact reference.
RecordedSamples make_scene_s(int width, int height, int spp, std::uint64_t seed);

}  // namespace spool
