#include "lib/kernels/scene_luminance.h"

#include "lib/statistics/analysis_signal.h"

namespace spool {

double scene_luminance(const PieceStatistics& statistics, GuardCounts& guards) {
  const int q = statistics.pieces_per_side;
  GuardCounts counted_by_the_filter;  // empty pieces
  const RgbImage mean = pixel_means(statistics, counted_by_the_filter);
  Plane of_pixel(mean[0].width(), mean[0].height());
  CountImage n(of_pixel.width(), of_pixel.height());
  for (int y = 0; y < of_pixel.height(); ++y) {
    for (int x = 0; x < of_pixel.width(); ++x) {
      of_pixel(x, y) = luminance(mean[0](x, y), mean[1](x, y), mean[2](x, y));
      for (int piece = 0; piece < q * q; ++piece)
        n(x, y) += statistics.n(x * q + piece % q, y * q + piece / q);
    }
  }
  return 1.0 / exposure_scale(of_pixel, n, guards);
}

}  // namespace spool
