#include "lib/kernels/pixel_cells.h"

#include <algorithm>
#include <bit>

namespace spool {
namespace {

int cell_of(float film) {
  return std::clamp(static_cast<int>(film * static_cast<float>(kCellsPerPixel)), 0,
                    kCellsPerPixel - 1);
}

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

}  // namespace

void cell_means_of_row(const PieceStatistics& statistics, const SamplePool& pool,
                       const RgbImage& pixel_mean, int y, int x0, int x1,
                       const std::array<double*, 3>& to) {
  const PieceSamples samples(pool);
  const int q = statistics.pieces_per_side;
  const bool film = pool.recording().has_film();
  const std::ptrdiff_t row = std::ptrdiff_t{kCellsPerPixel} * (x1 - x0);
  for (int x = x0; x < x1; ++x) {
    CellSums cells;
    for (int py = y * q; film && py < (y + 1) * q; ++py) {
      for (int px = x * q; px < (x + 1) * q; ++px) {
        samples.each(px, py, statistics.n(px, py),
                     [&](const FilmPosition& at, const Rgb& radiance) { cells.add(at, radiance); });
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      for (int j = 0; j < kCellsPerPixel; ++j)
        std::fill_n(to[c] + j * row + (x - x0) * kCellsPerPixel, kCellsPerPixel,
                    pixel_mean[c](x, y));
    }
    for (unsigned left = cells.occupied; left != 0; left &= left - 1) {
      const auto cell = static_cast<std::size_t>(std::countr_zero(left));
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(cell / kCellsPerPixel) * row +
                                (x - x0) * kCellsPerPixel + static_cast<int>(cell % kCellsPerPixel);
      for (std::size_t c = 0; c < 3; ++c)
        to[c][at] = cells.sum[cell][c] / cells.count[cell];
    }
  }
}

}  // namespace spool
