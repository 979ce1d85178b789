// The cells of the subpixel grid as one image, which slow twins take.
#pragma once

#include "lib/kernels/pixel_cells.h"

namespace spool::test {

// [c][4 height][4 width]; an empty cell has its pixel's mean.
inline RgbImage cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                           const RgbImage& pixel_mean) {
  const int width = pixel_mean[0].width(), height = pixel_mean[0].height();
  RgbImage cells = make_rgb(kCellsPerPixel * width, kCellsPerPixel * height);
  for (int y = 0; y < height; ++y) {
    const int row = y * kCellsPerPixel;
    cell_means_of_row(
        statistics, pool, pixel_mean, y, 0, width,
        {cells[0].row(row).data(), cells[1].row(row).data(), cells[2].row(row).data()});
  }
  return cells;
}

}  // namespace spool::test
