#include "lib/filters/twin_guides/guides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lib/core/parallel.h"
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
  double sigma;
  GuideSlack slack;
  float noise_left() const {
    return static_cast<float>(1.0 / std::max(1.0, 2.0 * std::numbers::pi * sigma * sigma));
  }
};

void guide_of_pilot(const Level& level, float floor, int width, float* value, float* variance) {
  for (int x = 0; x < width; ++x) {
    const float b = std::max(value[x], 0.0f) + floor;
    value[x] = std::log(b);
    variance[x] =
        std::min(level.slack(level.noise_left() * variance[x] / (b * b)), kLargestVariance);
  }
}

void guide_of_logarithms(const Level& level, int width, float* variance) {
  for (int x = 0; x < width; ++x)
    variance[x] = std::min(level.slack(level.noise_left() * variance[x]), kLargestVariance);
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
      paste(blend.mean[c], tile, sources.mean[0][c]);
      paste(blend.variance[c], tile, sources.variance[0][c]);
    }
  });
  moments.variance = {};
  sources.mean[1] = std::move(moments.log_mean);
  sources.variance[1] = std::move(moments.log_variance);
  return sources;
}

GuideLevels guide_levels(const GuideSources& sources, const CountImage& n,
                         const RadianceScale& scale, const TwinGuidesOptions& options) {
  const double sigma = options.guide_sigma;
  const long long samples = std::accumulate(n.pixels().begin(), n.pixels().end(), 0LL);
  const double small = options.small_noise * options.small_noise * static_cast<double>(n.size()) /
                       static_cast<double>(samples);
  return {std::make_shared<const GuideSources>(blurred(sources, sigma)),
          std::make_shared<const GuideSources>(
              options.stretch > 0.0 ? blur_along(sources, 2.0 * sigma, options.stretch, scale.mean)
                                    : blurred(sources, 2.0 * sigma)),
          {static_cast<float>(options.small_slack), static_cast<float>(options.slack),
           static_cast<float>(small)}};
}

GuidePyramid::GuidePyramid(GuideLevels finest, const RadianceScale& scale,
                           const TwinGuidesOptions& options)
    : scene_luminance_(scale.mean), guide_sigma_(options.guide_sigma), levels_(std::move(finest)) {}

void GuidePyramid::coarsen() {
  levels_.fine = std::move(levels_.coarse);
  levels_.coarse = std::make_shared<const GuideSources>(
      blurred(*levels_.fine, std::numbers::sqrt3 * 2.0 * guide_sigma_, step_));
  step_ *= 2;
}

TilePlanes GuidePyramid::guides(const Lattice& lattice, const Rectangle& around) const {
  const auto floor = static_cast<float>(kPilotFloor * scene_luminance_);
  TilePlanes planes(around, 2 * kGuideChannels);
  for (std::size_t channel = 0; channel < kGuideChannels; ++channel) {
    const std::size_t c = channel % 6 / 2, kind = channel % 2;
    const bool fine = channel < 6;
    const GuideSources& level = fine ? *levels_.fine : *levels_.coarse;
    const Level at{guide_sigma_ * step_ * (fine ? 1.0 : 2.0), levels_.slack};
    planes.copy_clamped(2 * channel, level.mean[kind][c], lattice);
    planes.copy_clamped(2 * channel + 1, level.variance[kind][c], lattice);
    for (int y = around.y0; y < around.y1; ++y) {
      float* variance = planes.at(2 * channel + 1, around.x0, y);
      if (kind == 0) {
        guide_of_pilot(at, floor, around.width(), planes.at(2 * channel, around.x0, y), variance);
      } else {
        guide_of_logarithms(at, around.width(), variance);
      }
    }
  }
  return planes;
}

}  // namespace spool
