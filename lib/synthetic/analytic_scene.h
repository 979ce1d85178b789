// Scenes given by formulas: every sample from counter-based random numbers, and the expectation and
// variance of every pixel known exactly. Ground truth without a renderer.
//
// A sample is drawn at a position uniform in its pixel, with two more uniform numbers t and q for
// whatever else is random (visibility, lens, time). Samples are independent, so recordings are
// exchangeable.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "lib/pool/recorded_samples.h"
#include "lib/synthetic/pixel_quadrature.h"

namespace spool {

struct SampleDraw {
  double x = 0, y = 0;  // position in the image, pixels
  double t = 0, q = 0;  // uniform in [0, 1)
};

struct AnalyticScene {
  std::string name;
  int width = 0, height = 0;                       // pixels
  std::array<double, 3> tint = {1.0, 1.0, 1.0};    // radiance [c] = tint[c] * value
  std::function<double(const SampleDraw&)> value;  // of one sample
  std::function<Moments(int x, int y)> moments;    // of the samples of a pixel
};

struct SyntheticSample {
  Rgb radiance;
  FilmPosition film;
};

// Sample s of pixel (x, y): a pure function of seed and indices.
SyntheticSample synthetic_sample(const AnalyticScene& scene, std::uint64_t seed, int x, int y,
                                 int s);

// Expectation of every pixel, [c][y][x]; variance of one sample beside it (infinite where it has
// none).
struct ExactImage {
  RgbImage mean, sample_variance;
};
ExactImage exact_image(const AnalyticScene& scene);

// A recording in memory with film positions and the exact reference.
RecordedSamples make_recording(const AnalyticScene& scene, int spp, std::uint64_t seed,
                               const SanitiseRules& rules = {});

}  // namespace spool
