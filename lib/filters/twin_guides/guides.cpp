#include "lib/filters/twin_guides/guides.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr BlendOptions kPilot = {1e-2f, 0, 2, 0.7};
// A variance of logarithms beyond this, twice in one distance, covers any difference of two.
constexpr float kLargestVariance = 1e3f;

// A part of an image as an image of its own.
Image<float> cut_out(const Image<float>& image, const Rectangle& part) {
  Image<float> result(part.width(), part.height());
  for (int y = part.y0; y < part.y1; ++y)
    std::copy_n(&image(part.x0, y), part.width(), result.row(y - part.y0).data());
  return result;
}

// One level of one kind.
struct Level {
  double sigma, slack;
  float noise_left() const {
    return static_cast<float>(slack / std::max(1.0, 2.0 * std::numbers::pi * sigma * sigma));
  }
};

void guide_of_pilot(const Level& level, float floor, Image<float>& value, Image<float>& variance) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    const float b = std::max(value[i], 0.0f) + floor;
    value[i] = std::log(b);
    variance[i] = std::min(level.noise_left() * variance[i] / (b * b), kLargestVariance);
  }
}

void guide_of_logarithms(const Level& level, Image<float>& variance) {
  for (float& v : variance.pixels())
    v = std::min(level.noise_left() * v, kLargestVariance);
}

}  // namespace

TilePlanes guides_around(const Rectangle& covered, const SampleMoments& moments,
                         const FeatureImages& features, const RadianceScale& scale,
                         const TwinGuidesOptions& options) {
  const int reach = four_sigma_taps(2.0 * options.guide_sigma).last();
  const Rectangle part = grow(covered, reach, reach, reach, reach, moments.mean[0].bounds());
  const std::array<const Image<float>*, 3> means = {&moments.mean[0], &moments.mean[1],
                                                    &moments.mean[2]};
  const std::array<const Image<float>*, 3> variances = {&moments.variance[0], &moments.variance[1],
                                                        &moments.variance[2]};
  const Blend pilot = feature_blend(part, means, variances, features, kPilot);
  const auto floor = static_cast<float>(kPilotFloor * scale.mean);
  TilePlanes guides(covered, 2 * kGuideChannels);
  std::size_t plane = 0;
  for (const double sigma : {options.guide_sigma, 2.0 * options.guide_sigma}) {
    const Level level{sigma, options.slack};
    for (std::size_t c = 0; c < 3; ++c) {
      Image<float> value = convolve(pilot.mean[c], four_sigma_taps(sigma));
      Image<float> variance = convolve(pilot.variance[c], four_sigma_taps(sigma));
      guide_of_pilot(level, floor, value, variance);
      guides.copy_clamped(plane++, value, part.x0, part.y0);
      guides.copy_clamped(plane++, variance, part.x0, part.y0);
      value = convolve(cut_out(moments.log_mean[c], part), four_sigma_taps(sigma));
      variance = convolve(cut_out(moments.log_variance[c], part), four_sigma_taps(sigma));
      guide_of_logarithms(level, variance);
      guides.copy_clamped(plane++, value, part.x0, part.y0);
      guides.copy_clamped(plane++, variance, part.x0, part.y0);
    }
  }
  return guides;
}

}  // namespace spool
