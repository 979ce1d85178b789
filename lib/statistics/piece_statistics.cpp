#include "lib/statistics/piece_statistics.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/statistics/block_means.h"
#include "lib/statistics/block_statistics.h"

namespace spool {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void welford(double& mean, double& m2, std::int32_t n_after, double value) {
  const double delta = value - mean;
  mean += delta / n_after;
  m2 += delta * (value - mean);
}

// Rows of a tile that one thread goes through. Short bands for many threads, but whole tiles where
// each thread would read the blocks again.
constexpr int kBandRows = 8;

struct Band {
  int tile = 0;
  Rectangle pixels;
};

std::vector<Band> bands_of(const LayerBlocks& blocks) {
  const LayerGrid& grid = blocks.grid();
  const int rows = blocks.in_place() ? kBandRows : grid.tile_size;
  std::vector<Band> bands;
  for (int t = 0; t < grid.tiles(); ++t) {
    const Rectangle tile = grid.tile(t);
    for (int y = tile.y0; y < tile.y1; y += rows)
      bands.push_back({t, {tile.x0, y, tile.x1, std::min(y + rows, tile.y1)}});
  }
  return bands;
}

// body(x, y) for every piece, tile by tile, in parallel: as samples lie in the file.
template <class Body>
void for_each_piece(const SamplePool& pool, const Body& body) {
  const std::vector<Band> bands = bands_of(pool.recording().blocks());
  const int q = pool.pieces_per_side();
  parallel_for(bands.size(), [&](std::size_t i) {
    const Rectangle& pixels = bands[i].pixels;
    for (int y = q * pixels.y0; y < q * pixels.y1; ++y) {
      for (int x = q * pixels.x0; x < q * pixels.x1; ++x)
        body(x, y);
    }
  });
}

// body(block, row_begin, row_end) for every block with samples among the first counts(x, y), those
// of a tile in their order, in parallel.
template <class Body>
void for_each_block(const SamplePool& pool, const CountImage& counts, const Body& body) {
  const LayerBlocks& blocks = pool.recording().blocks();
  const std::vector<Band> bands = bands_of(blocks);
  parallel_for(bands.size(), [&](std::size_t i) {
    const Rectangle& pixels = bands[i].pixels;
    int most = 0;
    for (int y = pixels.y0; y < pixels.y1; ++y)
      most =
          std::max(most, *std::max_element(&counts(pixels.x0, y), &counts(pixels.x1 - 1, y) + 1));
    for (int b = 0; b < blocks.grid().blocks() && blocks.grid().first_sample(b) < most; ++b)
      body(blocks.view(bands[i].tile, b), pixels.y0, pixels.y1);
  });
}

// Whether block_statistics.h knows how to add the pool's samples to the signal.
bool goes_by_blocks(const SamplePool& pool, const AnalysisSignal& signal) {
  return pool.as_recorded() && signal.channel == AnalysisChannel::kLuminance;
}

void check_prefix(const SamplePool& pool, const CountImage& counts) {
  SPOOL_CHECK_EQ(counts.width(), pool.width());
  SPOOL_CHECK_EQ(counts.height(), pool.height());
  for (const std::int32_t count : counts.pixels())
    SPOOL_CHECK_LE(count, pool.capacity(0, 0));
}

// [y][x] rings to the nearest piece with samples, by Chebyshev distance: 0 where there are some,
// the longer side where no piece has any. One pass brings what comes from above and from the left,
// one what comes from below and from the right.
CountImage rings_to_samples(const CountImage& n) {
  const int reach = std::max(n.width(), n.height());
  CountImage rings(n.width(), n.height(), reach);
  const auto look = [&](int x, int y, int back) {
    std::int32_t& own = rings(x, y);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}}) {
      const int px = x - back * dx, py = y - back * dy;
      if (n.bounds().contains(px, py) && rings(px, py) < own) own = rings(px, py) + 1;
    }
    if (n(x, y) > 0) own = 0;
  };
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      look(x, y, 1);
  }
  for (int y = n.height(); y-- > 0;) {
    for (int x = n.width(); x-- > 0;)
      look(x, y, -1);
  }
  return rings;
}

// Index of the piece with samples that is nearest to (x, y) on the ring of this Chebyshev radius:
// the smallest Euclidean distance wins, then the lowest index. -1 where the ring has none.
std::ptrdiff_t nearest_non_empty(const CountImage& n, int x, int y, int radius) {
  std::ptrdiff_t best = -1;
  long long best_distance = std::numeric_limits<long long>::max();
  for (int dy = -radius; dy <= radius; ++dy) {
    const bool edge_row = dy == -radius || dy == radius;
    for (int dx = -radius; dx <= radius; dx += edge_row ? 1 : 2 * radius) {
      const int px = x + dx, py = y + dy;
      if (!n.bounds().contains(px, py) || n(px, py) == 0) continue;
      const long long distance = static_cast<long long>(dx) * dx + static_cast<long long>(dy) * dy;
      if (distance < best_distance) {
        best_distance = distance;
        best = static_cast<std::ptrdiff_t>(n.index(px, py));
      }
    }
  }
  return best;
}

}  // namespace

ScalarStatistics::ScalarStatistics(int width, int height)
    : mean(width, height),
      m2(width, height),
      minimum(width, height, kInfinity),
      maximum(width, height, -kInfinity) {}

void ScalarStatistics::add(std::size_t piece, std::int32_t n_after, double value) {
  welford(mean[piece], m2[piece], n_after, value);
  minimum[piece] = std::min(minimum[piece], value);
  maximum[piece] = std::max(maximum[piece], value);
}

PieceStatistics means_of(int pieces_per_side, CountImage n, RgbImage mean) {
  PieceStatistics statistics;
  statistics.pieces_per_side = pieces_per_side;
  statistics.n = std::move(n);
  statistics.mean = std::move(mean);
  return statistics;
}

PieceStatistics empty_statistics(const SamplePool& pool, const AnalysisSignal& signal,
                                 bool channel_extremes) {
  const int width = pool.width(), height = pool.height();
  PieceStatistics statistics;
  statistics.pieces_per_side = pool.pieces_per_side();
  statistics.n = CountImage(width, height);
  statistics.mean = make_rgb(width, height);
  statistics.m2 = make_rgb(width, height);
  statistics.signal = signal;
  statistics.analysis = ScalarStatistics(width, height);
  if (channel_extremes) {
    statistics.channel_minimum = make_rgb(width, height, kInfinity);
    statistics.channel_maximum = make_rgb(width, height, -kInfinity);
  }
  return statistics;
}

void add_sample(PieceStatistics& statistics, std::size_t piece, const Rgb& value) {
  const std::int32_t n = ++statistics.n[piece];
  for (std::size_t c = 0; c < 3; ++c) {
    welford(statistics.mean[c][piece], statistics.m2[c][piece], n, value[c]);
  }
  if (statistics.channel_minimum) {
    for (std::size_t c = 0; c < 3; ++c) {
      double& low = (*statistics.channel_minimum)[c][piece];
      double& high = (*statistics.channel_maximum)[c][piece];
      low = std::min<double>(low, value[c]);
      high = std::max<double>(high, value[c]);
    }
  }
  statistics.analysis.add(piece, n, statistics.signal.value(value));
}

void take(PieceStatistics& statistics, const SamplePool& pool, int x, int y, int count) {
  const std::size_t piece = statistics.n.index(x, y);
  SPOOL_CHECK_LE(statistics.n[piece] + count, pool.capacity(x, y));
  for (int i = 0; i < count; ++i)
    add_sample(statistics, piece, pool.sample(x, y, statistics.n[piece]));
}

void take_each(PieceStatistics& statistics, const SamplePool& pool, const CountImage& counts) {
  SPOOL_CHECK_EQ(counts.width(), pool.width());
  SPOOL_CHECK_EQ(counts.height(), pool.height());
  for_each_piece(pool, [&](int x, int y) {
    if (counts(x, y) > 0) take(statistics, pool, x, y, counts(x, y));
  });
}

long long take_everywhere(PieceStatistics& statistics, const SamplePool& pool, int spp) {
  CountImage counts(pool.width(), pool.height());
  long long total = 0;
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      counts(x, y) = std::min(spp, pool.capacity(x, y) - statistics.n(x, y));
      total += counts(x, y);
    }
  }
  take_each(statistics, pool, counts);
  return total;
}

PieceStatistics prefix_statistics(const SamplePool& pool, const CountImage& counts,
                                  const AnalysisSignal& signal, bool channel_extremes) {
  PieceStatistics statistics = empty_statistics(pool, signal, channel_extremes);
  if (channel_extremes || !goes_by_blocks(pool, signal)) {
    take_each(statistics, pool, counts);
    return statistics;
  }
  check_prefix(pool, counts);
  for_each_block(pool, counts, [&](const BlockView& block, int begin, int end) {
    ScalarStatistics& of_signal = statistics.analysis;
    add_block({&statistics.mean, &statistics.m2, &of_signal.mean, &of_signal.m2, &of_signal.minimum,
               &of_signal.maximum},
              signal.exposure, block, counts, begin, end);
  });
  statistics.n = counts;
  return statistics;
}

PieceStatistics prefix_means(const SamplePool& pool, const CountImage& counts) {
  if (!goes_by_blocks(pool, {})) {
    PieceStatistics all = prefix_statistics(pool, counts);
    return means_of(all.pieces_per_side, std::move(all.n), std::move(all.mean));
  }
  check_prefix(pool, counts);
  RgbImage mean = make_rgb(pool.width(), pool.height());
  for_each_block(pool, counts, [&](const BlockView& block, int begin, int end) {
    add_block_means(block, counts, begin, end, mean);
  });
  return means_of(pool.pieces_per_side(), counts, std::move(mean));
}

void set_signal(PieceStatistics& statistics, const SamplePool& pool, const AnalysisSignal& signal) {
  if (statistics.signal == signal) return;
  statistics.signal = signal;
  ScalarStatistics& analysis = statistics.analysis;
  analysis = ScalarStatistics(statistics.width(), statistics.height());
  if (goes_by_blocks(pool, signal)) {
    for_each_block(pool, statistics.n, [&](const BlockView& block, int begin, int end) {
      add_block(
          {nullptr, nullptr, &analysis.mean, &analysis.m2, &analysis.minimum, &analysis.maximum},
          signal.exposure, block, statistics.n, begin, end);
    });
    return;
  }
  for_each_piece(pool, [&](int x, int y) {
    const std::size_t piece = statistics.n.index(x, y);
    for (int i = 0; i < statistics.n[piece]; ++i)
      analysis.add(piece, i + 1, signal.value(pool.sample(x, y, i)));
  });
}

double exposure_of(const PieceStatistics& statistics, GuardCounts& guards) {
  return exposure_scale(statistics.analysis.mean, statistics.n, guards) *
         statistics.signal.exposure;
}

Plane fill_empty_pieces(Plane pieces, const CountImage& n, int pieces_per_side,
                        GuardCounts& guards) {
  const int q = pieces_per_side;
  CountImage rings;  // made where a whole pixel is empty
  std::once_flag made;
  std::vector<std::uint64_t> empty(static_cast<std::size_t>(pieces.height()), 0);
  // In place and by all threads: empty pieces are written, the others are read.
  parallel_rows(0, pieces.height(), [&](int y) {
    for (int x = 0; x < pieces.width(); ++x) {
      if (n(x, y) > 0) continue;
      ++empty[static_cast<std::size_t>(y)];
      double sum = 0.0;
      int count = 0;
      for (int py = y / q * q; py < y / q * q + q; ++py) {
        for (int px = x / q * q; px < x / q * q + q; ++px) {
          if (n(px, py) == 0) continue;
          sum += pieces(px, py);
          ++count;
        }
      }
      if (count > 0) {
        pieces(x, y) = sum / count;
        continue;
      }
      std::call_once(made, [&] { rings = rings_to_samples(n); });
      const std::ptrdiff_t nearest = nearest_non_empty(n, x, y, rings(x, y));
      if (nearest >= 0) pieces(x, y) = pieces[static_cast<std::size_t>(nearest)];
    }
  });
  for (const std::uint64_t of_row : empty)
    guards.add(Guard::kEmptyPiece, of_row);
  return pieces;
}

Plane average_pieces(const Plane& pieces, int pieces_per_side) {
  const int q = pieces_per_side;
  if (q == 1) return pieces;
  Plane pixels(pieces.width() / q, pieces.height() / q);
  parallel_rows(0, pixels.height(), [&](int y) {
    for (int x = 0; x < pixels.width(); ++x) {
      double sum = 0.0;
      for (int j = 0; j < q; ++j) {
        for (int i = 0; i < q; ++i)
          sum += pieces(x * q + i, y * q + j);
      }
      pixels(x, y) = sum / (q * q);
    }
  });
  return pixels;
}

Plane pieces_to_pixels(const Plane& pieces, const CountImage& n, int pieces_per_side,
                       GuardCounts& guards) {
  const int q = pieces_per_side;
  Plane filled = fill_empty_pieces(pieces, n, q, guards);
  if (q == 1) return filled;
  return average_pieces(filled, q);
}

RgbImage pixel_means(const PieceStatistics& statistics, GuardCounts& guards) {
  GuardCounts once;
  RgbImage pixels;
  for (std::size_t c = 0; c < 3; ++c) {
    GuardCounts of_channel;
    pixels[c] =
        pieces_to_pixels(statistics.mean[c], statistics.n, statistics.pieces_per_side, of_channel);
    once = of_channel;  // the three channels share their empty pieces: count them once
  }
  guards += once;
  return pixels;
}

}  // namespace spool
