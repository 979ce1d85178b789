#include "lib/kernels/pixel_base.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/row_sums.h"

namespace spool {
namespace {

int cell_of(float film) {
  return std::clamp(static_cast<int>(film * static_cast<float>(kCellsPerPixel)), 0,
                    kCellsPerPixel - 1);
}

// Rows of pixels whose cells are computed together; the cells of two more on either side are
// computed again.
constexpr int kBandRows = 32, kBandReach = 2;

constexpr std::size_t kCells = kCellsPerPixel * kCellsPerPixel;

// The first samples of a piece with their film positions.
class PieceSamples {
 public:
  explicit PieceSamples(const SamplePool& pool)
      : pool_(pool),
        radiance_(pool.recording().blocks()),
        as_they_lie_(pool.as_recorded() && radiance_.in_place()) {}

  // body(film position, radiance) of the first n samples of piece (x, y), in their order.
  template <class Body>
  void each(int x, int y, int n, const Body& body) const {
    if (!as_they_lie_) {
      for (int s = 0; s < n; ++s)
        body(pool_.film(x, y, s), pool_.sample(x, y, s));
      return;
    }
    // Those of a block lie side by side.
    const int block = radiance_.grid().block_spp;
    for (int s = 0; s < n;) {
      const LayerBlocks::Place at = radiance_.place_of(x, y, s);
      const float* value = at.value;
      for (const int end = std::min(n, s - s % block + block); s < end; ++s, ++value) {
        body(pool_.recording().film(x, y, s),
             Rgb{value[0], value[at.channel], value[2 * at.channel]});
      }
    }
  }

 private:
  const SamplePool& pool_;
  const LayerBlocks& radiance_;
  bool as_they_lie_;
};

// Sums of the samples in the cells of a pixel.
struct CellSums {
  std::array<std::array<double, 3>, kCells> sum{};
  std::array<int, kCells> count{};
  unsigned occupied = 0;  // bit of each cell that has a sample

  void add(const FilmPosition& film, const Rgb& radiance) {
    const auto cell = static_cast<std::size_t>(cell_of(film.y) * kCellsPerPixel + cell_of(film.x));
    occupied |= 1u << cell;
    ++count[cell];
    for (std::size_t c = 0; c < 3; ++c)
      sum[cell][c] += static_cast<double>(radiance[c]);
  }
};

// Means of the cells of one row of pixels, to[c] [kCellsPerPixel][kCellsPerPixel * width].
void cell_means_of_row(const PieceStatistics& statistics, const PieceSamples& samples,
                       const RgbImage& pixel_mean, int y, const std::array<double*, 3>& to) {
  const int width = pixel_mean[0].width(), q = statistics.pieces_per_side;
  const std::ptrdiff_t row = std::ptrdiff_t{kCellsPerPixel} * width;
  for (int x = 0; x < width; ++x) {
    CellSums cells;
    for (int py = y * q; py < (y + 1) * q; ++py) {
      for (int px = x * q; px < (x + 1) * q; ++px) {
        samples.each(px, py, statistics.n(px, py),
                     [&](const FilmPosition& film, const Rgb& radiance) {
                       cells.add(film, radiance);
                     });
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      for (int j = 0; j < kCellsPerPixel; ++j)
        std::fill_n(to[c] + j * row + x * kCellsPerPixel, kCellsPerPixel, pixel_mean[c](x, y));
    }
    for (unsigned left = cells.occupied; left != 0; left &= left - 1) {
      const auto cell = static_cast<std::size_t>(std::countr_zero(left));
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(cell / kCellsPerPixel) * row +
                                x * kCellsPerPixel + static_cast<int>(cell % kCellsPerPixel);
      for (std::size_t c = 0; c < 3; ++c)
        to[c][at] = cells.sum[cell][c] / cells.count[cell];
    }
  }
}

// The cell at offset m from the centre line of pixel i is cell 4 i + 2 + m.
int first_cell(int i, const Taps& taps) {
  return i * kCellsPerPixel + kCellsPerPixel / 2 + taps.first;
}

// Filters one row of cells to its pixels.
void filter_along_row(const double* cells, int width, const Taps& taps, double* to) {
  // Every fourth cell together: pixels that follow each other read what lies side by side.
  std::vector<double> phases(static_cast<std::size_t>(kCellsPerPixel * width));
  for (int phase = 0; phase < kCellsPerPixel; ++phase) {
    for (int x = 0; x < width; ++x)
      phases[static_cast<std::size_t>(phase * width + x)] = cells[x * kCellsPerPixel + phase];
  }
  const int terms = static_cast<int>(taps.values.size());
  const int begin = std::min(kBandReach, width), end = std::max(begin, width - kBandReach);
  const auto border = [&](int x) {
    double sum = 0.0, inside = 0.0;
    for (int i = 0; i < terms; ++i) {
      const int cell = first_cell(x, taps) + i;
      if (cell < 0 || cell >= kCellsPerPixel * width) continue;
      const double tap = taps.values[static_cast<std::size_t>(i)];
      sum += tap * cells[cell];
      inside += tap;
    }
    to[x] = sum / inside;
  };
  for (int x = 0; x < begin; ++x)
    border(x);
  if (begin < end) {
    std::vector<const double*> sources;
    for (int i = 0; i < terms; ++i) {
      const int cell = first_cell(begin, taps) + i;
      sources.push_back(
          &phases[static_cast<std::size_t>(cell % kCellsPerPixel * width + cell / kCellsPerPixel)]);
    }
    weighted_sum_of_rows(sources.data(), taps.values.data(), sources.size(), end - begin,
                         to + begin);
    const double inside = tap_sum(taps);
    for (int x = begin; x < end; ++x)
      to[x] /= inside;
  }
  for (int x = end; x < width; ++x)
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
  const PieceSamples samples(pool);
  RgbImage cells = make_rgb(kCellsPerPixel * width, kCellsPerPixel * height);
  parallel_rows(0, height, [&](int y) {
    const int row = y * kCellsPerPixel;
    cell_means_of_row(
        statistics, samples, pixel_mean, y,
        {cells[0].row(row).data(), cells[1].row(row).data(), cells[2].row(row).data()});
  });
  return cells;
}

Plane filter_cells(const Plane& cells) {
  const int width = cells.width() / kCellsPerPixel, height = cells.height() / kCellsPerPixel;
  const Taps taps = cell_filter_taps();
  Plane rows(width, cells.height()), out(width, height);
  parallel_rows(0, cells.height(), [&](int y) {
    filter_along_row(cells.row(y).data(), width, taps, rows.row(y).data());
  });
  parallel_rows(0, height, [&](int y) {
    filter_across_rows(rows.row(0).data(), 0, width, height, y, taps, out.row(y).data());
  });
  return out;
}

RgbImage filtered_cell_means(const PieceStatistics& statistics, const SamplePool& pool,
                             const RgbImage& pixel_mean) {
  const int width = pixel_mean[0].width(), height = pixel_mean[0].height();
  const Taps taps = cell_filter_taps();
  const PieceSamples samples(pool);
  RgbImage out = make_rgb(width, height);
  const int bands = (height + kBandRows - 1) / kBandRows;
  parallel_for(static_cast<std::size_t>(bands), [&](std::size_t band) {
    const int y0 = static_cast<int>(band) * kBandRows, y1 = std::min(y0 + kBandRows, height);
    const int first = std::max(0, y0 - kBandReach), last = std::min(y1 + kBandReach, height);
    RgbImage cells = make_rgb(kCellsPerPixel * width, kCellsPerPixel);
    RgbImage rows = make_rgb(width, (last - first) * kCellsPerPixel);
    for (int y = first; y < last; ++y) {
      cell_means_of_row(statistics, samples, pixel_mean, y,
                        {cells[0].row(0).data(), cells[1].row(0).data(), cells[2].row(0).data()});
      for (std::size_t c = 0; c < 3; ++c) {
        for (int j = 0; j < kCellsPerPixel; ++j) {
          filter_along_row(cells[c].row(j).data(), width, taps,
                           rows[c].row((y - first) * kCellsPerPixel + j).data());
        }
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = y0; y < y1; ++y) {
        filter_across_rows(rows[c].row(0).data(), first * kCellsPerPixel, width, height, y, taps,
                           out[c].row(y).data());
      }
    }
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
