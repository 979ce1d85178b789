// What the fits of one scale take of every piece, and what they make of it.
//
// On the finest scale that is the piece itself. On a coarser one it is a small mean around it under
// the weights of the scale before (coarser_inputs.h): colours and regressors alike, so that where a
// colour depends linearly on position and features, its means depend on theirs in the same way.
#pragma once

#include <vector>

#include "lib/filters/twin_guides/clean_features.h"
#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

struct ScaleInputs {
  FloatRgb colour;      // clamped samples, in units
  FloatRgb difference;  // of their halves, as large as the noise of the colour
  Image<float> log_luminance;
  Image<float> right, down;            // where the mean lies, less the piece; pieces of the image
  std::vector<Image<float>> features;  // raw
};

ScaleInputs finest_inputs(SampleMoments moments, std::vector<Image<float>> raw_features);

// Of the size of the image, to be filled tile by tile.
ScaleInputs empty_inputs(int width, int height, std::size_t features);

struct ScaleImages {
  FloatRgb image;  // in units
  FloatRgb noise;  // the fit of `difference`: one draw of the noise of `image` under these weights
};

ScaleImages empty_images(int width, int height);

}  // namespace spool
