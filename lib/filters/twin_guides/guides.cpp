#include "lib/filters/twin_guides/guides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/twin_guides/directional_guides.h"
#include "lib/filters/twin_guides/tiles.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr BlendOptions kPilot = {1e-2f, 2, 0.7};
// A variance of logarithms beyond this, twice in one distance, covers any difference of two.
constexpr float kLargestVariance = 1e3f;

GuideSources blurred(const GuideSources& sources, double sigma, int dilation = 1) {
  GuideSources result;
  const Taps taps = four_sigma_taps(sigma);
  parallel_for(12, [&](std::size_t i) {
    const std::size_t kind = i / 6, c = i % 3;
    if (i / 3 % 2 == 0) {
      result.mean[kind][c] = convolve(sources.mean[kind][c], taps, dilation);
    } else {
      result.variance[kind][c] = convolve(sources.variance[kind][c], taps, dilation);
    }
  });
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

GuideSources guide_sources(SampleMoments& moments, const FeatureImages& features) {
  const int width = moments.mean[0].width(), height = moments.mean[0].height();
  GuideSources sources;
  sources.mean[0].fill(Image<float>(width, height));
  sources.variance[0] = sources.mean[0];
  const std::array<const Image<float>*, 3> means = {&moments.mean[0], &moments.mean[1],
                                                    &moments.mean[2]};
  const std::array<const Image<float>*, 3> variances = {&moments.variance[0], &moments.variance[1],
                                                        &moments.variance[2]};
  parallel_tiles(width, height, [&](const Rectangle& tile) {
    const Blend blend = feature_blend(tile, means, variances, features, kPilot);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        std::copy_n(blend.mean[c].row(y - tile.y0).data(), tile.width(),
                    &sources.mean[0][c](tile.x0, y));
        std::copy_n(blend.variance[c].row(y - tile.y0).data(), tile.width(),
                    &sources.variance[0][c](tile.x0, y));
      }
    }
  });
  moments.variance = {};
  sources.mean[1] = std::move(moments.log_mean);
  sources.variance[1] = std::move(moments.log_variance);
  return sources;
}

GuideLevels guide_levels(const GuideSources& sources, const RadianceScale& scale,
                         const TwinGuidesOptions& options) {
  const double sigma = options.guide_sigma;
  return {blurred(sources, sigma),
          options.stretch > 0.0 ? blur_along(sources, 2.0 * sigma, options.stretch, scale.mean)
                                : blurred(sources, 2.0 * sigma)};
}

GuidePyramid::GuidePyramid(GuideLevels finest, const RadianceScale& scale,
                           const TwinGuidesOptions& options)
    : scene_luminance_(scale.mean),
      guide_sigma_(options.guide_sigma),
      slack_(options.slack),
      levels_(std::move(finest)) {}

void GuidePyramid::coarsen() {
  GuideSources coarser = blurred(levels_.coarse, std::numbers::sqrt3 * 2.0 * guide_sigma_, step_);
  levels_ = {std::move(levels_.coarse), std::move(coarser)};
  step_ *= 2;
}

GuideImages GuidePyramid::take_guides() {
  const auto floor = static_cast<float>(kPilotFloor * scene_luminance_);
  GuideImages result{std::vector<Image<float>>(kGuideChannels),
                     std::vector<Image<float>>(kGuideChannels)};
  parallel_for(kGuideChannels, [&](std::size_t channel) {
    const std::size_t level = channel / 6, c = channel % 6 / 2, kind = channel % 2;
    const Level at{guide_sigma_ * step_ * (level == 0 ? 1.0 : 2.0), slack_};
    Image<float> value =
        level == 0 ? std::move(levels_.fine.mean[kind][c]) : levels_.coarse.mean[kind][c];
    Image<float> variance =
        level == 0 ? std::move(levels_.fine.variance[kind][c]) : levels_.coarse.variance[kind][c];
    if (kind == 0) {
      guide_of_pilot(at, floor, value, variance);
    } else {
      guide_of_logarithms(at, variance);
    }
    result.value[channel] = std::move(value);
    result.variance[channel] = std::move(variance);
  });
  return result;
}

}  // namespace spool
