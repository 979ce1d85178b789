#include "lib/filters/pixel_base.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/filters/truncated_filter.h"

namespace spool {
namespace {

int cell_of(float film) {
  return std::clamp(static_cast<int>(film * static_cast<float>(kCellsPerPixel)), 0,
                    kCellsPerPixel - 1);
}

}  // namespace

Taps cell_filter_taps() {
  Taps taps{-10, {}};
  for (int i = 0; i < 20; ++i) {
    const double d = (i + 0.5 - 10.0) / kCellsPerPixel;
    taps.values.push_back(std::max(0.0, std::exp(-2.0 * d * d) - std::exp(-8.0)));
  }
  return scaled(taps, 1.0 / tap_sum(taps));
}

RgbImage cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                    const RgbImage& pixel_mean) {
  const int width = pixel_mean[0].width(), height = pixel_mean[0].height();
  const int q = statistics.pieces_per_side;
  RgbImage cells = make_rgb(kCellsPerPixel * width, kCellsPerPixel * height);
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      std::array<std::array<double, 3>, kCellsPerPixel * kCellsPerPixel> sum{};
      std::array<int, kCellsPerPixel * kCellsPerPixel> count{};
      for (int py = y * q; py < (y + 1) * q; ++py) {
        for (int px = x * q; px < (x + 1) * q; ++px) {
          for (int s = 0; s < statistics.n(px, py); ++s) {
            const FilmPosition film = pool.film(px, py, s);
            const Rgb radiance = pool.sample(px, py, s);
            const auto cell =
                static_cast<std::size_t>(cell_of(film.y) * kCellsPerPixel + cell_of(film.x));
            ++count[cell];
            for (std::size_t c = 0; c < 3; ++c)
              sum[cell][c] += static_cast<double>(radiance[c]);
          }
        }
      }
      for (std::size_t cell = 0; cell < count.size(); ++cell) {
        const int cx = x * kCellsPerPixel + static_cast<int>(cell) % kCellsPerPixel;
        const int cy = y * kCellsPerPixel + static_cast<int>(cell) / kCellsPerPixel;
        for (std::size_t c = 0; c < 3; ++c) {
          cells[c](cx, cy) = count[cell] > 0 ? sum[cell][c] / count[cell] : pixel_mean[c](x, y);
        }
      }
    }
  });
  return cells;
}

Plane filter_cells(const Plane& cells) {
  const int width = cells.width() / kCellsPerPixel, height = cells.height() / kCellsPerPixel;
  const Taps taps = cell_filter_taps();
  // The cell at offset m from the pixel's centre line is cell 4 x + 2 + m.
  const auto sum_at = [&](int position, int n, auto&& value) {
    double sum = 0.0, inside = 0.0;
    for (int m = taps.first; m <= taps.last(); ++m) {
      const int cell = position * kCellsPerPixel + kCellsPerPixel / 2 + m;
      if (cell < 0 || cell >= n) continue;
      const double tap = taps.values[static_cast<std::size_t>(m - taps.first)];
      sum += tap * value(cell);
      inside += tap;
    }
    return sum / inside;
  };
  Plane rows(width, cells.height()), out(width, height);
  parallel_rows(0, cells.height(), [&](int y) {
    for (int x = 0; x < width; ++x)
      rows(x, y) = sum_at(x, cells.width(), [&](int cell) { return cells(cell, y); });
  });
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x)
      out(x, y) = sum_at(y, cells.height(), [&](int cell) { return rows(x, cell); });
  });
  return out;
}

PixelKernel compose_with_base(const Taps& gaussian, bool subpixel) {
  if (!subpixel) {
    const Taps taps = convolved_taps(gaussian, pixel_filter_taps());
    return {taps, squared_taps(taps)};
  }
  Taps spread{kCellsPerPixel * gaussian.first,
              std::vector<double>(kCellsPerPixel * (gaussian.values.size() - 1) + 1, 0.0)};
  for (std::size_t i = 0; i < gaussian.values.size(); ++i)
    spread.values[kCellsPerPixel * i] = gaussian.values[i];
  const Taps cells = convolved_taps(spread, cell_filter_taps());
  // Cell m lies in pixel floor((m + 2) / 4) from the centre's.
  const auto pixel_of = [](int m) {
    return static_cast<int>(std::floor((m + 0.5 * kCellsPerPixel) / kCellsPerPixel));
  };
  const int first = pixel_of(cells.first), last = pixel_of(cells.last());
  PixelKernel kernel;
  kernel.taps = kernel.squares = {
      first, std::vector<double>(static_cast<std::size_t>(last - first + 1), 0.0)};
  for (int m = cells.first; m <= cells.last(); ++m) {
    const double tap = cells.values[static_cast<std::size_t>(m - cells.first)];
    const auto pixel = static_cast<std::size_t>(pixel_of(m) - first);
    kernel.taps.values[pixel] += tap;
    kernel.squares.values[pixel] += kCellsPerPixel * tap * tap;
  }
  return kernel;
}

}  // namespace spool
