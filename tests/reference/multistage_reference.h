// Slow twin of lib/filters/multistage.h for one channel, stage by stage; NaN is undefined.
#pragma once

#include <cmath>
#include <limits>

#include "lib/statistics/piece_statistics.h"

namespace spool::reference {

// NaN where a pixel stays undefined.
inline Plane multistage(const PieceStatistics& statistics, const SamplePool& pool, std::size_t c) {
  const int q = statistics.pieces_per_side;
  const int width = statistics.width() / q, height = statistics.height() / q;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  Plane cells(4 * width, 4 * height);
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      double sum = 0.0;
      int count = 0;
      for (int py = y / 4 * q; py < (y / 4 + 1) * q; ++py) {
        for (int px = x / 4 * q; px < (x / 4 + 1) * q; ++px) {
          for (int s = 0; s < statistics.n(px, py); ++s) {
            const FilmPosition film = pool.film(px, py, s);
            const int cx = static_cast<int>(4 * film.x), cy = static_cast<int>(4 * film.y);
            if (cx != x % 4 || cy != y % 4) continue;
            sum += static_cast<double>(pool.sample(px, py, s)[c]);
            ++count;
          }
        }
      }
      cells(x, y) = count > 0 ? sum / count : undefined;
    }
  }
  const auto window_mean = [&](const Plane& in, int x, int y, int first, int last) {
    double sum = 0.0;
    int count = 0;
    for (int j = y + first; j <= y + last; ++j) {
      for (int i = x + first; i <= x + last; ++i) {
        if (!in.bounds().contains(i, j) || std::isnan(in(i, j))) continue;
        sum += in(i, j);
        ++count;
      }
    }
    return count > 0 ? sum / count : undefined;
  };
  Plane stage1 = cells, stage2 = cells, out(width, height);
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x)
      stage1(x, y) = window_mean(cells, x, y, -1, 0);
  }
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x)
      stage2(x, y) = window_mean(stage1, x, y, -1, 2);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      out(x, y) = window_mean(stage2, 4 * x, 4 * y, 0, 3);
  }
  return out;
}

}  // namespace spool::reference
