#include "lib/filters/box.h"

#include <gtest/gtest.h>

#include "tests/filters/small_pools.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::select_counts;
using testing::select_uniform;

Reconstruction run(const Selection& selection, const SamplePool& pool) {
  auto result = reconstruct_box(selection, pool, {}, {});
  EXPECT_TRUE(result.has_value());
  return std::move(*result);
}

TEST(Box, PixelIsTheMeanOfItsSamples) {
  const SamplePool pool = make_pool(5, 3, 6, noisy_picture(5, 3, 1));
  const Reconstruction result = run(select_uniform(pool, 4), pool);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (int s = 0; s < 4; ++s)
          sum += pool.sample(x, y, s)[c];
        EXPECT_NEAR(result.image[c](x, y), sum / 4, 1e-15);
      }
    }
  }
}

TEST(Box, VarianceIsTheSampleVarianceOfTheMean) {
  const SamplePool pool = make_pool(4, 4, 8, noisy_picture(4, 4, 2));
  const Reconstruction result = run(select_uniform(pool, 8), pool);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      double mean = 0.0, squares = 0.0;
      for (int s = 0; s < 8; ++s)
        mean += pool.sample(x, y, s)[1] / 8.0;
      for (int s = 0; s < 8; ++s) {
        const double d = pool.sample(x, y, s)[1] - mean;
        squares += d * d;
      }
      EXPECT_NEAR((*result.variance)[1](x, y), squares / 7 / 8, 1e-15);
    }
  }
}

TEST(Box, QuarterPixelsAverageTheirPiecesAndVariances) {
  const std::vector<FilmPosition> film = {{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}, {0.9f, 0.9f},
                                          {0.2f, 0.2f}, {0.8f, 0.2f}, {0.2f, 0.8f}, {0.8f, 0.8f}};
  const SamplePool pool = make_pool(3, 2, 8, noisy_picture(3, 2, 3), {.pieces_per_side = 2}, film);
  // One piece of a pixel has two samples, the others one: equal areas, not equal samples.
  const Selection selection =
      select_counts(pool, [](int x, int y) { return x % 2 == 0 && y % 2 == 0 ? 2 : 1; });
  const Reconstruction result = run(selection, pool);
  ASSERT_EQ(result.image[0].width(), 3);
  ASSERT_EQ(result.image[0].height(), 2);
  const auto value = [&](int s) {
    return static_cast<double>(pool.recording().radiance(1, 1, s)[0]);
  };
  const double expected = ((value(0) + value(4)) / 2 + value(1) + value(2) + value(3)) / 4;
  EXPECT_NEAR(result.image[0](1, 1), expected, 1e-15);
  EXPECT_GT((*result.variance)[0](1, 1), 0.0);
}

TEST(Box, EmptyPixelsTakeTheirNeighboursAndAreCounted) {
  const SamplePool pool = make_pool(3, 3, 4, noisy_picture(3, 3, 4));
  const Selection selection =
      select_counts(pool, [](int x, int y) { return x == 1 && y == 1 ? 0 : 4; });
  const Reconstruction result = run(selection, pool);
  EXPECT_EQ(result.image[0](1, 1), result.image[0](1, 0));  // nearest, lowest index
  EXPECT_EQ((*result.variance)[0](1, 1), (*result.variance)[0](1, 0));
  EXPECT_EQ(result.guards[Guard::kEmptyPiece], 1u);
}

TEST(Box, NoSampleAtAllIsAnErrorThatSaysSo) {
  const SamplePool pool = make_pool(2, 2, 4, noisy_picture(2, 2, 5));
  const auto result = reconstruct_box(select_uniform(pool, 0), pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_NE(result.error().message.find("no piece has a sample"), std::string::npos);
}

TEST(Box, ExposureByAPowerOfTwoScalesTheImageExactly) {
  const auto picture = noisy_picture(9, 7, 6);
  const SamplePool pool = make_pool(9, 7, 3, picture);
  const SamplePool brighter = make_pool(9, 7, 3, [&](int x, int y, int s) {
    Rgb value = picture(x, y, s);
    for (float& v : value)
      v *= 1024.0f;
    return value;
  });
  const Reconstruction a = run(select_uniform(pool, 3), pool);
  const Reconstruction b = run(select_uniform(brighter, 3), brighter);
  for (std::size_t i = 0; i < a.image[0].size(); ++i) {
    EXPECT_EQ(a.image[0][i] * 1024.0, b.image[0][i]);
    EXPECT_EQ((*a.variance)[0][i] * 1024.0 * 1024.0, (*b.variance)[0][i]);
  }
}

}  // namespace
}  // namespace spool
