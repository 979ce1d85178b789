#include "lib/kernels/pixel_base.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/row_sums.h"

namespace spool {
namespace {

// Pixels of a block whose cells are computed together; those of two more on every side are computed
// again.
constexpr int kBlockRows = 32, kBlockColumns = 64, kReach = 2;

// Taps of the pixel filter on cells of a quarter pixel: distances (i + 1/2 - 10) / 4, i = 0 .. 19,
// sum 1; the first belongs to the cell 10 before the pixel's centre.
Taps cell_filter_taps() {
  Taps taps{-10, {}};
  for (int i = 0; i < 20; ++i) {
    const double d = (i + 0.5 - 10.0) / kCellsPerPixel;
    taps.values.push_back(std::max(0.0, std::exp(-2.0 * d * d) - std::exp(-8.0)));
  }
  return scaled(taps, 1.0 / tap_sum(taps));
}

// The cell at offset m from the centre line of pixel i is cell 4 i + 2 + m.
int first_cell(int i, const Taps& taps) {
  return i * kCellsPerPixel + kCellsPerPixel / 2 + taps.first;
}

// Filters one row of cells to its pixels x0 .. x1 - 1; `cells` begins with those of pixel `first`
// and has those of `pixels` of them. `width`: of the image.
void filter_along_row(const double* cells, int first, int pixels, int x0, int x1, int width,
                      const Taps& taps, double* to) {
  // Every fourth cell together: pixels that follow each other read what lies side by side.
  std::vector<double> phases(static_cast<std::size_t>(kCellsPerPixel * pixels));
  for (int phase = 0; phase < kCellsPerPixel; ++phase) {
    for (int x = 0; x < pixels; ++x)
      phases[static_cast<std::size_t>(phase * pixels + x)] = cells[x * kCellsPerPixel + phase];
  }
  const int terms = static_cast<int>(taps.values.size());
  const int begin = std::clamp(kReach, x0, x1), end = std::clamp(width - kReach, begin, x1);
  const auto border = [&](int x) {
    double sum = 0.0, inside = 0.0;
    for (int i = 0; i < terms; ++i) {
      const int cell = first_cell(x, taps) + i;
      if (cell < 0 || cell >= kCellsPerPixel * width) continue;
      const double tap = taps.values[static_cast<std::size_t>(i)];
      sum += tap * cells[cell - kCellsPerPixel * first];
      inside += tap;
    }
    to[x - x0] = sum / inside;
  };
  for (int x = x0; x < begin; ++x)
    border(x);
  if (begin < end) {
    std::vector<const double*> sources;
    for (int i = 0; i < terms; ++i) {
      const int cell = first_cell(begin, taps) + i - kCellsPerPixel * first;
      sources.push_back(&phases[static_cast<std::size_t>(cell % kCellsPerPixel * pixels +
                                                         cell / kCellsPerPixel)]);
    }
    weighted_sum_of_rows(sources.data(), taps.values.data(), sources.size(), end - begin,
                         to + (begin - x0));
    const double inside = tap_sum(taps);
    for (int x = begin; x < end; ++x)
      to[x - x0] /= inside;
  }
  for (int x = end; x < x1; ++x)
    border(x);
}

// Filters the rows of pixel y, each filtered along itself; `rows` begin with cell row `first`.
void filter_across_rows(const double* rows, int first, int width, int height, int y,
                        const Taps& taps, double* to) {
  std::vector<const double*> sources;
  const int begin = std::max(0, first_cell(y, taps));
  const int end =
      std::min(kCellsPerPixel * height, first_cell(y, taps) + static_cast<int>(taps.values.size()));
  const double* weights = &taps.values[static_cast<std::size_t>(begin - first_cell(y, taps))];
  double inside = 0.0;
  for (int cell = begin; cell < end; ++cell) {
    sources.push_back(rows + std::ptrdiff_t{cell - first} * width);
    inside += weights[cell - begin];
  }
  weighted_sum_of_rows(sources.data(), weights, sources.size(), width, to);
  for (int x = 0; x < width; ++x)
    to[x] /= inside;
}

// filtered_cell_means() of the pixels of `block`.
void filter_block(const PieceStatistics& statistics, const SamplePool& pool,
                  const RgbImage& pixel_mean, const Rectangle& block, const Taps& taps,
                  RgbImage& out) {
  const Rectangle bounds = out[0].bounds(),
                  read = grow(block, kReach, kReach, kReach, kReach, bounds);
  RgbImage cells = make_rgb(kCellsPerPixel * read.width(), kCellsPerPixel);
  RgbImage rows = make_rgb(block.width(), read.height() * kCellsPerPixel);
  for (int y = read.y0; y < read.y1; ++y) {
    cell_means_of_row(statistics, pool, pixel_mean, y, read.x0, read.x1,
                      {cells[0].row(0).data(), cells[1].row(0).data(), cells[2].row(0).data()});
    for (std::size_t c = 0; c < 3; ++c) {
      for (int j = 0; j < kCellsPerPixel; ++j) {
        filter_along_row(cells[c].row(j).data(), read.x0, read.width(), block.x0, block.x1,
                         bounds.x1, taps, rows[c].row((y - read.y0) * kCellsPerPixel + j).data());
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = block.y0; y < block.y1; ++y) {
      filter_across_rows(rows[c].row(0).data(), read.y0 * kCellsPerPixel, block.width(), bounds.y1,
                         y, taps, &out[c](block.x0, y));
    }
  }
}

// filter_block() of each block of `out` that is `wanted`, in parallel.
template <class Wanted>
void filter_blocks(const PieceStatistics& statistics, const SamplePool& pool,
                   const RgbImage& pixel_mean, const Wanted& wanted, RgbImage& out) {
  const Taps taps = cell_filter_taps();
  parallel_tiles(out[0].bounds(), kBlockColumns, kBlockRows, [&](const Rectangle& block) {
    if (wanted(block)) filter_block(statistics, pool, pixel_mean, block, taps, out);
  });
}

}  // namespace

RgbImage filtered_cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                             const RgbImage& pixel_mean) {
  RgbImage out = make_rgb(pixel_mean[0].width(), pixel_mean[0].height());
  filter_blocks(statistics, pool, pixel_mean, [](const Rectangle&) { return true; }, out);
  return out;
}

void refilter_cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                         const RgbImage& pixel_mean, const CountImage& before, RgbImage& filtered) {
  const CountImage& n = statistics.n;
  const int q = statistics.pieces_per_side, reach = q * kReach;
  const auto changed = [&](const Rectangle& block) {
    const Rectangle pieces = grow({q * block.x0, q * block.y0, q * block.x1, q * block.y1}, reach,
                                  reach, reach, reach, n.bounds());
    for (int y = pieces.y0; y < pieces.y1; ++y) {
      for (int x = pieces.x0; x < pieces.x1; ++x) {
        // An empty piece has the mean of others, which may have changed.
        if (n(x, y) != before(x, y) || n(x, y) == 0) return true;
      }
    }
    return false;
  };
  filter_blocks(statistics, pool, pixel_mean, changed, filtered);
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
