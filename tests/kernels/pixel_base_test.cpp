// The base image of greedy selection: cells, their filter, and the same again with more samples.
#include "lib/kernels/pixel_base.h"

#include <gtest/gtest.h>

#include "tests/filters/small_pools.h"
#include "tests/reference/greedy_selection_reference.h"
#include "tests/support/cell_means.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::random_film;
using testing::select_uniform;

TEST(PixelBase, CellsWithoutSamplesTakeThePixelMeanAndEqualCellsChangeNothing) {
  const SamplePool pool = make_pool(4, 3, 5, noisy_picture(4, 3, 2), {}, random_film(5));
  const Selection selection = select_uniform(pool, 5);
  const RgbImage flat = {Plane(4, 3, 2.0), Plane(4, 3, 2.0), Plane(4, 3, 2.0)};
  const RgbImage cells = test::cell_means(selection.statistics, pool, flat);
  int taken_from_mean = 0;
  for (const double v : cells[0].pixels())
    taken_from_mean += v == 2.0 ? 1 : 0;
  EXPECT_GE(taken_from_mean, 4 * 3 * 11);  // at most 5 of 16 cells of a pixel have a sample
  const SamplePool even =
      make_pool(4, 3, 5, [](int, int, int) { return Rgb{2.0f, 2.0f, 2.0f}; }, {}, random_film(5));
  const RgbImage filtered = filtered_cell_means(select_uniform(even, 5).statistics, even, flat);
  for (const double v : filtered[0].pixels())
    EXPECT_NEAR(v, 2.0, 1e-15);
}

TEST(PixelBase, WithoutFilmPositionsEveryCellHasThePixelMean) {
  const SamplePool pool = make_pool(4, 3, 5, noisy_picture(4, 3, 2));
  const PieceStatistics statistics = select_uniform(pool, 5).statistics;
  const RgbImage cells = test::cell_means(statistics, pool, statistics.mean);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x)
      EXPECT_EQ(cells[1](x, y), statistics.mean[1](x / 4, y / 4));
  }
}

TEST(PixelBase, BlocksGiveThePixelFilterOfTheWholeImage) {
  for (const auto& [width, height] :
       {std::pair{7, 70}, {2, 3}, {33, 32}, {1, 1}, {5, 34}, {66, 4}, {130, 35}}) {
    const SamplePool pool =
        make_pool(width, height, 5, noisy_picture(width, height, 2), {}, random_film(5));
    const PieceStatistics statistics = select_uniform(pool, 4).statistics;
    const RgbImage cells = test::cell_means(statistics, pool, statistics.mean);
    const RgbImage filtered = filtered_cell_means(statistics, pool, statistics.mean);
    const RgbImage expected = reference::greedy_base(statistics.mean, &cells);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < filtered[c].size(); ++i)
        ASSERT_NEAR(filtered[c][i], expected[c][i], 1e-13) << width << "x" << height;
    }
  }
}

// Where blocks begin decides no bit: a part of the picture, cut elsewhere into blocks, has the
// same.
TEST(PixelBase, BlocksGiveTheSameBitsWhereverTheyBegin) {
  constexpr int kWidth = 150, kHeight = 80, kX = 23, kY = 13, kBorder = 3;
  const auto picture = noisy_picture(kWidth, kHeight, 2);
  const auto filtered = [&](int x0, int y0) {
    const SamplePool pool = make_pool(
        kWidth - x0, kHeight - y0, 5,
        [&](int x, int y, int s) { return picture(x + x0, y + y0, s); }, {}, random_film(5));
    const PieceStatistics statistics = select_uniform(pool, 4).statistics;
    return filtered_cell_means(statistics, pool, statistics.mean);
  };
  const RgbImage whole = filtered(0, 0), part = filtered(kX, kY);
  for (int y = kBorder; y < kHeight - kY; ++y) {
    for (int x = kBorder; x < kWidth - kX; ++x)
      ASSERT_EQ(part[1](x, y), whole[1](x + kX, y + kY)) << x << ", " << y;
  }
}

TEST(PixelBase, MoreSamplesOfSomePixelsGiveTheBitsOfAllAnew) {
  for (const auto& [width, height] : {std::pair{150, 70}, {3, 2}, {64, 33}}) {
    const SamplePool pool =
        make_pool(width, height, 6, noisy_picture(width, height, 2), {}, random_film(6));
    PieceStatistics statistics = select_uniform(pool, 3).statistics;
    for (const int more : {1, 2}) {
      const CountImage before = statistics.n;
      RgbImage filtered = filtered_cell_means(statistics, pool, statistics.mean);
      take(statistics, pool, (more * 37) % width, (more * 34) % height, more);
      take(statistics, pool, width - 1, height - 1, 1);
      refilter_cell_means(statistics, pool, statistics.mean, before, filtered);
      EXPECT_EQ(filtered, filtered_cell_means(statistics, pool, statistics.mean));
    }
  }
}

}  // namespace
}  // namespace spool
