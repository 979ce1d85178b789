#include "lib/filters/multistage.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/box.h"

namespace spool {
namespace {

constexpr int kCells = 4;     // per pixel side
constexpr int kBandRows = 8;  // pixels whose cells are held together
constexpr int kColumns = 32;  // pixels whose samples are read together

// Sums of defined values [c], and how many there are.
struct Cells {
  RgbImage sum;
  Plane count;
};

// Replaces sums by means with count 1 where anything is defined.
void take_means(Cells& cells) {
  for (std::size_t i = 0; i < cells.count.size(); ++i) {
    if (cells.count[i] == 0.0) continue;
    for (Plane& sum : cells.sum)
      sum[i] /= cells.count[i];
    cells.count[i] = 1.0;
  }
}

// Sum over the window [first, last]^2 of offsets; cells outside the grid are undefined.
Plane window_sum(const Plane& in, int first, int last) {
  const int width = in.width(), height = in.height();
  Plane rows(width, height), out(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int i = std::max(0, x + first); i <= std::min(width - 1, x + last); ++i)
        rows(x, y) += in(i, y);
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int j = std::max(0, y + first); j <= std::min(height - 1, y + last); ++j) {
      for (int x = 0; x < width; ++x)
        out(x, y) += rows(x, j);
    }
  }
  return out;
}

void apply_stage(Cells& cells, int first, int last) {
  for (Plane& sum : cells.sum)
    sum = window_sum(sum, first, last);
  cells.count = window_sum(cells.count, first, last);
  take_means(cells);
}

int cell_of(float film) {
  return std::clamp(static_cast<int>(film * static_cast<float>(kCells)), 0, kCells - 1);
}

// Stage 0 for the rows [first, last) of pixels. Columns go together, so that a recording that is
// read block by block is read once a band; every cell is of one pixel and sums in the order of its
// samples.
Cells cell_means(const PieceStatistics& statistics, const SamplePool& pool, int first, int last) {
  const int q = statistics.pieces_per_side;
  const int width = kCells * (statistics.width() / q), height = kCells * (last - first);
  Cells cells{make_rgb(width, height), Plane(width, height)};
  for (int left = 0; left < statistics.width(); left += kColumns * q) {
    const int right = std::min(left + kColumns * q, statistics.width());
    for (int py = first * q; py < last * q; ++py) {
      for (int px = left; px < right; ++px) {
        for (int s = 0; s < statistics.n(px, py); ++s) {
          const FilmPosition film = pool.film(px, py, s);
          const Rgb sample = pool.sample(px, py, s);
          const int x = px / q * kCells + cell_of(film.x);
          const int y = (py / q - first) * kCells + cell_of(film.y);
          for (std::size_t c = 0; c < 3; ++c)
            cells.sum[c](x, y) += static_cast<double>(sample[c]);
          cells.count(x, y) += 1.0;
        }
      }
    }
  }
  take_means(cells);
  return cells;
}

// The same, one band at a time where samples are read block by block: bands of several threads
// would put each other's blocks out of memory, and each would be read many times.
Cells cell_means_in_turn(const PieceStatistics& statistics, const SamplePool& pool, int first,
                         int last, std::mutex& reading) {
  std::unique_lock turn(reading, std::defer_lock);
  if (!pool.recording().blocks().in_place()) turn.lock();
  return cell_means(statistics, pool, first, last);
}

// All stages for the rows [y0, y1) of pixels. The row above and the one below, whose windows are
// not whole, hold all cells that these rows reach.
void filter_band(const PieceStatistics& statistics, const SamplePool& pool, int y0, int y1,
                 std::mutex& reading, RgbImage& image, CountImage& defined) {
  const int first = std::max(0, y0 - 1), last = std::min(y1 + 1, image[0].height());
  Cells cells = cell_means_in_turn(statistics, pool, first, last, reading);
  apply_stage(cells, -1, 0);
  apply_stage(cells, -1, 2);
  for (int y = y0; y < y1; ++y) {
    for (int x = 0; x < image[0].width(); ++x) {
      std::array<double, 3> sum{};
      double count = 0.0;
      for (int j = 0; j < kCells; ++j) {
        for (int i = 0; i < kCells; ++i) {
          const int cx = x * kCells + i, cy = (y - first) * kCells + j;
          if (cells.count(cx, cy) == 0.0) continue;
          for (std::size_t c = 0; c < 3; ++c)
            sum[c] += cells.sum[c](cx, cy);
          count += 1.0;
        }
      }
      defined(x, y) = count > 0.0 ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c)
        image[c](x, y) = count > 0.0 ? sum[c] / count : 0.0;
    }
  }
}

}  // namespace

Result<Reconstruction> reconstruct_multistage(const Selection& selection, const SamplePool& pool,
                                              const MultistageOptions&, const FilterContext&) {
  SPOOL_ASSIGN(Reconstruction result, reconstruct_box(selection, pool, {}, {}));
  if (!pool.recording().has_film()) {
    result.notes.push_back(
        "multistage: film positions were not recorded, so this is the box filter");
    return result;
  }
  result.variance.reset();
  const int height = result.image[0].height();
  CountImage defined(result.image[0].width(), height);
  const int bands = (height + kBandRows - 1) / kBandRows;
  std::mutex reading;
  parallel_for(static_cast<std::size_t>(bands), [&](std::size_t band) {
    const int y0 = static_cast<int>(band) * kBandRows;
    filter_band(selection.statistics, pool, y0, std::min(y0 + kBandRows, height), reading,
                result.image, defined);
  });
  for (Plane& image : result.image) {
    GuardCounts counted_by_box;
    image = fill_empty_pieces(std::move(image), defined, 1, counted_by_box);
  }
  return result;
}

Filter multistage_filter() {
  return make_value<FilterFunction, MultistageOptions>(
      {.name = "multistage",
       .summary = "box filters of growing width over quarter pixels",
       .source = Source::kDescriptions,
       .needs = [](const auto&) { return Needs{.film_positions = Use::kWhenRecorded}; },
       .memory = {160, 3e6},  // the cells of two bands are the larger constant
       .cost = 0.94,
       .run = reconstruct_multistage});
}

}  // namespace spool
