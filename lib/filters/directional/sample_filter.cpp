#include "lib/filters/directional/sample_filter.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/filters/directional/filter_offsets.h"

namespace spool {
namespace {

// A sample relative to the grid of the input, in pieces.
struct PlacedSample {
  double x, y;
  Rgb radiance;
};

// All samples behind the cursors, piece after piece: those of piece p are [begin[p], begin[p + 1]).
struct PlacedSamples {
  std::vector<PlacedSample> samples;
  std::vector<std::size_t> begin;
};

PlacedSamples place_samples(const CountImage& n, const SamplePool& pool, int x0, int y0) {
  PlacedSamples placed;
  placed.begin.assign(n.size() + 1, 0);
  for (std::size_t p = 0; p < n.size(); ++p)
    placed.begin[p + 1] = placed.begin[p] + static_cast<std::size_t>(n[p]);
  placed.samples.resize(placed.begin.back());
  const int q = pool.pieces_per_side();
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t begin = placed.begin[n.index(x, y)];
      for (int s = 0; s < n(x, y); ++s) {
        const FilmPosition film = pool.film(x0 + x, y0 + y, s);
        placed.samples[begin + static_cast<std::size_t>(s)] = {
            (x0 + x) / q * q + q * static_cast<double>(film.x) - x0,
            (y0 + y) / q * q + q * static_cast<double>(film.y) - y0,
            pool.sample(x0 + x, y0 + y, s)};
      }
    }
  });
  return placed;
}

// The sums of eq 10 for one piece.
struct PieceSums {
  double total = 0.0;
  std::array<double, 3> value{}, variance{};
};

// A piece whose neighbourhood is summed: (x, y) of level k, its width along each direction.
struct Centre {
  int x, y, level;
  std::span<const double> delta;
};

// Adds what the samples of piece (px, py) give to the centre's piece.
void add_piece(const FilterInput& input, const PlacedSamples& placed, const Centre& centre, int px,
               int py, std::span<const double> beta, const FilterOptions& options,
               PieceSums& sums) {
  const std::size_t p = input.n.index(px, py);
  const double count = input.n[p], radius = filter_radius(centre.level);
  const double share = options.weighting == FilterWeighting::kPerSample ? 1.0 : 1.0 / count;
  for (std::size_t s = placed.begin[p]; s < placed.begin[p + 1]; ++s) {
    const PlacedSample& sample = placed.samples[s];
    const double dx = sample.x - (centre.x + 0.5), dy = sample.y - (centre.y + 0.5);
    const double squared = dx * dx + dy * dy;
    const bool inside = options.window == FilterWindow::kDisc
                            ? squared <= radius * radius
                            : std::abs(dx) <= radius && std::abs(dy) <= radius;
    if (!inside) continue;
    double omega = 1.0;
    if (squared > 0.0) {
      const double b = std::atan2(dy, dx) * (180.0 / std::numbers::pi);
      const double along =
          interpolated_width(sector_of(b, beta), centre.delta, options.eq12);  // (12)
      omega = exp_negative(0.5 * squared / (along * along));                   // (11)
    }
    const double w = omega * share;
    sums.total += w;
    for (std::size_t c = 0; c < 3; ++c) {
      sums.value[c] +=
          w * (static_cast<double>(sample.radiance[c]) - input.mean[c](centre.x, centre.y));
      sums.variance[c] += w * w * count * input.variance[c][p];
    }
  }
}

}  // namespace

template <class T>
FilteredPieces filter_samples(const FilterInput& input, const FilterWidths<T>& widths,
                              const SamplePool& pool, int x0, int y0, const FilterOptions& options,
                              GuardCounts& guards) {
  const int width = input.level.width(), height = input.level.height();
  const PlacedSamples placed = place_samples(input.n, pool, x0, y0);
  FilteredPieces out{input.mean, input.variance};
  std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
  parallel_rows(0, height, [&](int y) {
    std::vector<double> delta(widths.beta.size());
    for (int x = 0; x < width; ++x) {
      const int k = input.level(x, y);
      if (k == 0) continue;
      for (std::size_t i = 0; i < delta.size(); ++i)
        delta[i] = static_cast<double>(widths.delta[i](x, y));
      const int radius = filter_radius(k);
      const Rectangle near =
          intersect({x - radius, y - radius, x + radius + 1, y + radius + 1}, input.level.bounds());
      PieceSums sums;
      for (int py = near.y0; py < near.y1; ++py) {
        for (int px = near.x0; px < near.x1; ++px) {
          if (input.n(px, py) == 0) continue;
          add_piece(input, placed, {x, y, k, delta}, px, py, widths.beta, options, sums);
        }
      }
      if (!(sums.total >= 1e-300)) {
        caught[static_cast<std::size_t>(y)].add(Guard::kZeroWeight);
        continue;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        out.image[c](x, y) += sums.value[c] / sums.total;  // (10)
        out.variance[c](x, y) = sums.variance[c] / (sums.total * sums.total);
      }
    }
  });
  for (const GuardCounts& row : caught)
    guards += row;
  return out;
}

template FilteredPieces filter_samples(const FilterInput&, const FilterWidths<double>&,
                                       const SamplePool&, int, int, const FilterOptions&,
                                       GuardCounts&);
template FilteredPieces filter_samples(const FilterInput&, const FilterWidths<float>&,
                                       const SamplePool&, int, int, const FilterOptions&,
                                       GuardCounts&);

}  // namespace spool
