// The base image I_0 of the greedy selection, on either of its grids, and kernels composed with it.
#pragma once

#include "lib/core/image.h"
#include "lib/kernels/pixel_cells.h"
#include "lib/pool/sample_pool.h"
#include "lib/pyramid/wavelet_filters.h"
#include "lib/statistics/selection.h"

namespace spool {

// The cells of pixel_cells.h under the pixel filter, one value per pixel, without an image of
// cells; windows are cut at the border and renormalised.
RgbImage filtered_cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                             const RgbImage& pixel_mean);
// Makes `filtered`, the filtered_cell_means() of the counts `before`, those of `statistics`, to the
// bit, which has taken more of the same samples: anew only around pieces that have.
void refilter_cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                         const RgbImage& pixel_mean, const CountImage& before, RgbImage& filtered);

// A convolution kernel over pixels: taps for values, and the squared taps that a variance is
// convolved with. On the subpixel grid a pixel's tap is the sum over its cells and the square 4
// times the sum of squares (the mean of a cell has 4 x 4 times the variance of the pixel's mean).
struct PixelKernel {
  Taps taps, squares;
};

// `gaussian` (over pixels) composed with the pixel filter.
PixelKernel compose_with_base(const Taps& gaussian, bool subpixel);

}  // namespace spool
