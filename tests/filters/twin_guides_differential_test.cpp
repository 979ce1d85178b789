// Every stage of twin_guides, and the whole of it, against the slow twin.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/twin_guides/clean_features.h"
#include "lib/filters/twin_guides/guides.h"
#include "lib/filters/twin_guides/twin_guides.h"
#include "lib/filters/twin_guides/window_weights.h"
#include "lib/kernels/sample_clamp.h"
#include "tests/filters/feature_images.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/sample_clamp_reference.h"
#include "tests/reference/test_images.h"
#include "tests/reference/twin_guides_reference.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_features;
using testing::noisy_picture;
using testing::select_counts;
using testing::to_double;
using testing::to_float;

// Pool with noisy features, counts from 1 or 2 to 8, and what both sides make of it.
struct Compared {
  SamplePool pool;
  CountImage n;
  Plane limit;
  RadianceScale scale;
};

Compared compared(const SamplePool& pool, int least) {
  const Selection selection =
      select_counts(pool, [=](int x, int y) { return least + (3 * x + y) % (9 - least); });
  GuardCounts guards;
  const RadianceScale scale = radiance_scale(selection.statistics, guards);
  const CountImage& n = selection.statistics.n;
  const double sigma = TwinGuidesOptions{}.clamp_sigma;
  // The twin of the limits wants samples in every pixel.
  return {pool, n,
          least > 0 ? reference::sample_limits(pool, n, 16.0, sigma, 0.005)
                    : sample_limits(pool, n, scale.mean / scale.unit, {.sigma = sigma}),
          scale};
}

void guides_agree(const GuidePyramid& pyramid, const reference::Guides& twin) {
  const int width = twin.value[0].width(), height = twin.value[0].height();
  const TilePlanes guides = pyramid.guides({1, 0, 0, width, height}, {0, 0, width, height});
  for (std::size_t c = 0; c < kGuideChannels; ++c) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double variance = twin.variance[c](x, y);
        ASSERT_NEAR(*guides.at(2 * c, x, y), twin.value[c](x, y), 5e-6) << c;
        ASSERT_NEAR(*guides.at(2 * c + 1, x, y), variance, 1e-5 * (1.0 + variance));
      }
    }
  }
}

// On one tile of a lattice that has others beside it.
void weights_agree(const Lattice& lattice, const GuidePyramid& pyramid,
                   const reference::Guides& twin, const FeatureImages& f,
                   const TwinGuidesOptions& options) {
  const Rectangle tile = {lattice.width / 3, 0, lattice.width, lattice.height / 2 + 1};
  if (intersect(tile, lattice.bounds()).empty()) return;
  const Rectangle inside = intersect(tile, lattice.bounds());
  const reference::Planes clean = to_double(f.value), clean_variance = to_double(f.variance);
  const WindowWeights weights(lattice, inside, {options.radius, options.sigma}, pyramid, f,
                              options);
  for (std::size_t o = 0; o < weights.offsets().size(); ++o) {
    const auto [dx, dy] = weights.offsets()[o];
    for (int y = inside.y0; y < inside.y1; ++y) {
      for (int x = inside.x0; x < inside.x1; ++x) {
        const double expected = lattice.bounds().contains(x + dx, y + dy)
                                    ? reference::window_weight(
                                          twin, clean, clean_variance, options.sigma * lattice.step,
                                          options, lattice.column(x), lattice.row(y),
                                          lattice.column(x + dx), lattice.row(y + dy))
                                    : 0.0;
        ASSERT_NEAR(weights.row(o, inside.x0, y)[x - inside.x0], expected, 2e-5)
            << lattice.step << " " << dx << " " << dy;
      }
    }
  }
}

TEST(TwinGuidesDifferential, GuidesAndWeights) {
  for (const auto& [width, height] : {std::pair{23, 17}, {9, 30}, {3, 2}}) {
    const Compared in = compared(make_pool(width, height, 8, noisy_picture(width, height, 7)), 2);
    GuardCounts guards;
    const TwinGuidesOptions options;
    const Plane heavy(width, height, 0.5);
    const NoisePool noise_pool{options.noise_pool, heavy};
    SampleMoments moments = sample_moments(in.pool, in.n, in.limit, noise_pool, in.scale, guards);
    const FeatureImages f = noisy_features(width, height, 7);
    const reference::Planes clean = to_double(f.value), clean_variance = to_double(f.variance);
    const reference::Moments m = reference::moments(in.pool, in.n, in.limit, noise_pool, in.scale);
    const std::vector<reference::GuideLevel> levels = reference::guide_levels(
        reference::guide_sources(m, clean, clean_variance), 4, in.scale, options);
    const GuideSources sources = guide_sources(moments, f);
    GuidePyramid pyramid(guide_levels(sources, in.n, in.scale, options), in.scale, options);
    for (std::size_t k = 0; k < 3; ++k) {
      const reference::Guides twin =
          reference::guides(levels, k, in.scale, reference::noise_of_means(options, in.n));
      guides_agree(pyramid, twin);
      for (int lattice = 0; lattice < pyramid.step() * pyramid.step(); lattice += 3)
        weights_agree(lattice_of(width, height, pyramid.step(), lattice), pyramid, twin, f,
                      options);
      pyramid.coarsen();
    }
  }
}

void whole_agrees(const SamplePool& pool, int least, const TwinGuidesOptions& options = {}) {
  const Compared in = compared(pool, least);
  const Selection selection{prefix_statistics(pool, in.n), {}};
  const auto result = reconstruct_twin_guides(selection, pool, options, {});
  ASSERT_TRUE(result.has_value()) << result.error().message;
  const RgbImage twin = reference::twin_guides(pool, in.n, in.limit, in.scale, options);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < twin[c].size(); ++i) {
      ASSERT_NEAR(result->image[c][i], twin[c][i], 1e-4 * (0.1 + std::abs(twin[c][i])))
          << in.n.width() << "x" << in.n.height() << " " << i;
    }
  }
}

TEST(TwinGuidesDifferential, TheWholeFilter) {
  for (const auto& [width, height] : test::twin_sizes()) {
    const auto picture = noisy_picture(width, height, 7);
    whole_agrees(make_pool(width, height, 8, picture), 2);
  }
  TwinGuidesOptions small;
  small.radius = 2;
  whole_agrees(make_pool(60, 47, 8, noisy_picture(60, 47, 8)), 2, small);    // four tiles
  whole_agrees(make_pool(113, 19, 8, noisy_picture(113, 19, 8)), 2, small);  // of a lattice, too
  small.scales = 1, small.stretch = 0.0;
  whole_agrees(make_pool(31, 12, 8, noisy_picture(31, 12, 5)), 2, small);
  small.scales = 5, small.stretch = 0.7;
  whole_agrees(make_pool(31, 12, 8, noisy_picture(31, 12, 6)), 2, small);
  whole_agrees(make_pool(20, 13, 8, noisy_picture(20, 13, 9)), 0);  // pixels without samples
  TwinGuidesOptions options;
  options.radius = 3, options.sigma = 1.5, options.guide_sigma = 1.0, options.slack = 1.0;
  options.tau = 0.2, options.detail_slack = 0.5, options.scales = 2, options.feature_gain = 0.5,
  options.cut = 2.0, options.ridge = 0.5;
  options.limit = 2.0;
  whole_agrees(make_pool(31, 12, 8, noisy_picture(31, 12, 10)), 2, options);
  TwinGuidesOptions wide;
  wide.guide_sigma = 2.0, wide.stretch = 3.0;
  whole_agrees(make_pool(24, 9, 8, noisy_picture(24, 9, 11)), 2, wide);
}

TEST(TwinGuidesDifferential, ALargePictureHasFourScales) {
  TwinGuidesOptions options;
  options.radius = 1;
  for (const int side : {362, 363}) {
    const auto pool = make_pool(side + 1, side, 2, noisy_picture(side + 1, side, 13));
    EXPECT_EQ(scale_count(options, side, side + 1), side == 363 ? 4 : 3);
    EXPECT_EQ(scale_count(options, side + 1, side), side == 363 ? 4 : 3);
    const Selection selection = testing::select_uniform(pool, 2);
    const auto image = [&](std::optional<int> scales) {
      options.scales = scales;
      const auto result = reconstruct_twin_guides(selection, pool, options, {});
      const auto pixels = result->image[1].pixels();
      return std::vector<double>(pixels.begin(), pixels.end());
    };
    const auto chosen = image({});
    EXPECT_EQ(chosen == image(3), side == 362);
    EXPECT_EQ(chosen == image(4), side == 363);
  }
}

TEST(TwinGuidesDifferential, TheWholeFilterOnDarkAlbedo) {
  const testing::FeatureFunction dark = [](std::string_view layer, std::size_t c, int x, int y,
                                           int s) {
    return (layer == "albedo" ? 0.1 : 1.0) * test::made_feature(layer, c, x, y, s, 24);
  };
  whole_agrees(make_pool(24, 15, 8, noisy_picture(24, 15, 12), {}, {}, dark), 2);
}

// Where there is no structure a guide that may stretch is the round one, as wide as it was asked.
TEST(TwinGuides, AWideGuideIsAsWideWithAStretchAsWithout) {
  const auto pool = make_pool(64, 48, 8, [](int x, int y, int s) {
    const auto v = static_cast<float>(1.0 + unit_double(mix(9, x, y, s)));
    return Rgb{v, v, v};
  });
  TwinGuidesOptions options;
  options.scales = 1, options.guide_sigma = 4.0, options.stretch = 0.0;
  const Selection selection = testing::select_uniform(pool, 8);
  const auto round = reconstruct_twin_guides(selection, pool, options, {});
  options.stretch = 1e-6;
  const auto stretched = reconstruct_twin_guides(selection, pool, options, {});
  double difference = 0.0;
  for (std::size_t p = 0; p < round->image[1].size(); ++p)
    difference += std::pow(round->image[1][p] - stretched->image[1][p], 2) /
                  static_cast<double>(round->image[1].size());

  EXPECT_LT(std::sqrt(difference), 1e-5);
}

TEST(TwinGuidesDifferential, TheWholeFilterWithFirefliesAndALamp) {
  const auto bright = [picture = noisy_picture(30, 20, 3)](int x, int y, int s) {
    Rgb value = picture(x, y, s);
    const float factor = x == 12 && y > 3 && y < 8   ? 900.0f
                         : mix(5, x, y, s) % 97 == 0 ? 80.0f
                                                     : 1.0f;
    for (float& v : value)
      v *= factor;
    return value;
  };
  whole_agrees(make_pool(30, 20, 8, bright), 2);
  whole_agrees(make_pool(30, 20, 8, bright), 2, heavy_tailed_twin_guides_options());
  TwinGuidesOptions options;
  options.agreement = 1.5;
  options.slack = 20.0, options.limit = 1.0;  // windows that hold fireflies, and a limit below them
  whole_agrees(make_pool(30, 20, 8, bright), 2, options);
}

TEST(TwinGuidesDifferential, TheWholeFilterWithoutFeatures) {
  RecordedSamples recording = make_pool(19, 14, 8, noisy_picture(19, 14, 4)).recording();
  recording.set_features({}, {});
  const auto pool =
      SamplePool::create(std::make_shared<const RecordedSamples>(std::move(recording)), {});
  whole_agrees(*pool, 1);
}

}  // namespace
}  // namespace spool
