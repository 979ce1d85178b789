// The baselines against their slow twins.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/filters/greedy_selection.h"
#include "lib/filters/multistage.h"
#include "lib/filters/nl_means.h"
#include "lib/filters/wavelet_transform.h"
#include "lib/kernels/piece_estimates.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/greedy_selection_reference.h"
#include "tests/reference/multistage_reference.h"
#include "tests/reference/nl_means_reference.h"
#include "tests/reference/test_images.h"
#include "tests/reference/wavelet_transform_reference.h"
#include "tests/support/cell_means.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::random_film;
using testing::select_counts;

TEST(GreedySelectionDifferential, ImagesVariancesAndScalesAgree) {
  for (const auto& [width, height] : test::twin_sizes()) {
    for (const auto& [subpixel, film] : {std::pair{false, true}, {true, true}, {true, false}}) {
      const SamplePool pool = make_pool(width, height, 8, noisy_picture(width, height, 7), {},
                                        film ? random_film(8) : std::vector<FilmPosition>());
      const Selection selection =
          select_counts(pool, [](int x, int y) { return 4 + (3 * x + y) % 5; });
      GreedySelectionOptions options;
      options.grid = subpixel ? GreedyGrid::kSubpixel : GreedyGrid::kPixel;
      options.scales = 6;
      const auto result = reconstruct_greedy_selection(selection, pool, options, {});
      ASSERT_TRUE(result.has_value());

      const PieceStatistics& statistics = selection.statistics;
      GuardCounts guards;
      const double exposure = analysis_exposure(statistics, guards);
      const auto pieces = estimate_pieces(statistics, {}, exposure, guards);
      Plane n(width, height);
      for (std::size_t i = 0; i < n.size(); ++i)
        n[i] = statistics.n[i];
      const RgbImage cells = test::cell_means(statistics, pool, statistics.mean);
      const auto expected =
          reference::greedy_selection(pieces->mean, pieces->variance, n,
                                      subpixel ? &cells : nullptr, 6, options.gamma, options.alpha);
      for (std::size_t i = 0; i < n.size(); ++i) {
        if (expected.margin[i] < 1e-12) continue;  // decided by rounding
        ASSERT_EQ((*result->level)[i], expected.level[i]) << width << "x" << height << subpixel;
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_NEAR(result->image[c][i], expected.image[c][i], 1e-13);
          ASSERT_NEAR((*result->variance)[c][i], expected.variance[c][i], 1e-14);
        }
      }
    }
  }
}

RgbImage filtered_by_tiles(const RgbImage& target, const HalfImage& guide,
                           const PatchFilterOptions& options) {
  RgbImage out = make_rgb(target[0].width(), target[0].height());
  const GuidedTargets guided = {{&target[0], &target[1], &target[2]}, &guide};
  filter_tiles({&guided, 1}, options, [&](const Rectangle& tile, const auto& filtered) {
    for (std::size_t c = 0; c < 3; ++c)
      paste(filtered[0][c], tile, out[c]);
  });
  return out;
}

TEST(NlMeansDifferential, WeightsAgreeWithTheDefinition) {
  for (const auto& [width, height] : test::twin_sizes()) {
    RgbImage target = make_rgb(width, height);
    HalfImage guide{target, target};
    for (std::size_t c = 0; c < 3; ++c) {
      target[c] = reference::noise_image(width, height, 30 + c);
      guide.mean[c] = reference::noise_image(width, height, 40 + c);
      guide.variance[c] = reference::noise_image(width, height, 50 + c);
      for (double& v : guide.variance[c].pixels())
        v = 0.5 * v * v;
    }
    for (const int patch : {0, 1, 3}) {  // 3 has code of its own
      PatchFilterOptions options;
      options.window = patch == 3 ? 1 : 3;
      options.patch = patch;
      const RgbImage out = filtered_by_tiles(target, guide, options);
      const RgbImage expected = reference::filter_with_guide(target, guide, options);
      // Values are up to 1, weights float.
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LT(reference::max_difference(out[c], expected[c]), 1e-6)
            << width << "x" << height << ", patch " << patch;
      }
    }
  }
}

TEST(MultistageDifferential, PixelsAgreeWhereTheyAreDefined) {
  for (const int q : {1, 2}) {
    for (const auto& [width, height] : test::twin_sizes()) {
      const SamplePool pool = make_pool(width, height, 12, noisy_picture(width, height, 8),
                                        {.pieces_per_side = q}, random_film(12));
      const Selection selection = select_counts(pool, [](int x, int y) { return (x + 2 * y) % 4; });
      const auto result = reconstruct_multistage(selection, pool, {}, {});
      if (!result.has_value()) continue;  // nothing sampled at all
      int defined = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Plane expected = reference::multistage(selection.statistics, pool, c);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          if (std::isnan(expected[i])) continue;
          ++defined;
          ASSERT_NEAR(result->image[c][i], expected[i], 1e-13);
        }
      }
      EXPECT_GT(defined, 0);
    }
  }
}

TEST(WaveletTransformDifferential, OneLevelAgreesForValuesAndVariances) {
  for (const auto& [width, height] : {std::pair{2, 2}, {2, 8}, {6, 4}, {16, 10}, {32, 34}}) {
    const Plane image = reference::noise_image(width, height, 60);
    for (const auto of : {TransformOf::kValues, TransformOf::kVariances}) {
      Plane transformed = image;
      forward_transform(transformed, 1, of);
      const Plane expected = reference::forward_level(image, of == TransformOf::kValues ? 1 : 2);
      EXPECT_LT(reference::max_difference(transformed, expected), 1e-13) << width << "x" << height;
    }
  }
}

// <T x, y> = <x, T' y>: what the transposed matrix is.
TEST(WaveletTransformDifferential, TheTransposedOnesAreTransposed) {
  const Plane a = reference::noise_image(32, 48, 61), b = reference::noise_image(32, 48, 62);
  const auto product = [](const Plane& x, const Plane& y) {
    return std::inner_product(x.pixels().begin(), x.pixels().end(), y.pixels().begin(), 0.0);
  };
  for (const int levels : {1, 2, 4}) {
    Plane of_a = a, of_b = b;
    forward_transform(of_a, levels, TransformOf::kValues);
    transposed_forward_transform(of_b, levels);
    EXPECT_NEAR(product(of_a, b), product(a, of_b), 1e-10) << levels;
    of_a = a, of_b = b;
    inverse_transform(of_a, levels);
    transposed_inverse_transform(of_b, levels);
    EXPECT_NEAR(product(of_a, b), product(a, of_b), 1e-10) << levels;
  }
}

TEST(WaveletTransformDifferential, InverseUndoesForward) {
  for (const auto& [width, height] : {std::pair{16, 16}, {16, 48}, {80, 32}}) {
    const Plane image = reference::firefly_image(width, height, 61);
    Plane back = image;
    forward_transform(back, 4, TransformOf::kValues);
    inverse_transform(back, 4);
    EXPECT_LT(reference::max_difference(back, image), 1e-12 * reference::max_abs(image));
  }
}

}  // namespace
}  // namespace spool
