#include "lib/filters/directional/sample_filter.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lib/core/arctangent.h"
#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/directional/filter_offsets.h"

namespace spool {
namespace {

// All samples behind the cursors, piece after piece and so row after row: those of piece p are
// [begin[p], begin[p + 1]). Positions are relative to the grid of the input, in pieces.
struct PlacedSamples {
  std::vector<double> x, y;
  std::vector<Rgb> radiance;
  std::vector<std::size_t> begin;
};

PlacedSamples place_samples(const CountImage& n, const SamplePool& pool, int x0, int y0) {
  PlacedSamples placed;
  placed.begin.assign(n.size() + 1, 0);
  for (std::size_t p = 0; p < n.size(); ++p)
    placed.begin[p + 1] = placed.begin[p] + static_cast<std::size_t>(n[p]);
  placed.x.resize(placed.begin.back());
  placed.y.resize(placed.begin.back());
  placed.radiance.resize(placed.begin.back());
  const int q = pool.pieces_per_side();
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t begin = placed.begin[n.index(x, y)];
      for (int s = 0; s < n(x, y); ++s) {
        const FilmPosition film = pool.film(x0 + x, y0 + y, s);
        const std::size_t i = begin + static_cast<std::size_t>(s);
        placed.x[i] = (x0 + x) / q * q + q * static_cast<double>(film.x) - x0;
        placed.y[i] = (y0 + y) / q * q + q * static_cast<double>(film.y) - y0;
        placed.radiance[i] = pool.sample(x0 + x, y0 + y, s);
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

// The width along every direction b in [0, 180): (1 - t) lower + t upper of the last sector that
// begins at or before b, t = (b - from) / span [LiuZheng (12)]. The same as sector_of() and
// interpolated_width(), laid out for vectors: what wraps around is the first sector, which begins
// below 0, and the last, which ends beyond 180.
struct WidthLines {
  std::vector<double> from, span, lower, upper;  // [sector]

  explicit WidthLines(std::span<const double> beta) {
    const std::size_t count = beta.size();
    for (std::size_t i = 0; i <= count; ++i) {
      const double begin = i == 0 ? beta[count - 1] - 180.0 : beta[i - 1];
      from.push_back(begin);
      span.push_back((i == count ? beta[0] + 180.0 : beta[i]) - begin);
    }
    lower.resize(count + 1);
    upper.resize(count + 1);
  }
  // delta[i] of beta_i
  void set(std::span<const double> delta, Eq12 form) {
    const std::size_t count = delta.size();
    for (std::size_t i = 0; i <= count; ++i) {
      const double below = delta[i == 0 ? count - 1 : i - 1], above = delta[i == count ? 0 : i];
      lower[i] = form == Eq12::kCorrected ? below : above;
      upper[i] = form == Eq12::kCorrected ? above : below;
    }
  }
};

// The region of a piece at (x, y), in pieces.
struct Window {
  double x, y, radius;
  bool disc;
};

// omega of eq 11 for `count` samples at (xs, ys), 0 outside the window.
SPOOL_VECTOR_CLONES
void sample_weights(const double* xs, const double* ys, int count, const Window& window,
                    const WidthLines& lines, double* __restrict omega) {
  const auto sectors = static_cast<int>(lines.from.size());
  const double *from = lines.from.data(), *span = lines.span.data();
  const double *lower = lines.lower.data(), *upper = lines.upper.data();
  const double radius = window.radius, squared_radius = radius * radius;
  const double cx = window.x, cy = window.y;
  const bool disc = window.disc;
  constexpr int kGroup = 64;
  double direction[kGroup], begin[kGroup], width[kGroup], low[kGroup], high[kGroup];
  for (int first = 0; first < count; first += kGroup) {
    const int n = count - first < kGroup ? count - first : kGroup;
    for (int i = 0; i < n; ++i)
      direction[i] = line_direction(xs[first + i] - cx, ys[first + i] - cy);
    for (int s = 0; s < sectors; ++s) {  // the last that begins before it
      const double of_begin = from[s], of_width = span[s], of_low = lower[s], of_high = upper[s];
      for (int i = 0; i < n; ++i) {
        const bool reached = s == 0 || direction[i] >= of_begin;
        begin[i] = reached ? of_begin : begin[i];
        width[i] = reached ? of_width : width[i];
        low[i] = reached ? of_low : low[i];
        high[i] = reached ? of_high : high[i];
      }
    }
    for (int i = 0; i < n; ++i) {
      const double dx = xs[first + i] - cx, dy = ys[first + i] - cy;
      const double squared = dx * dx + dy * dy;
      const double ax = dx < 0.0 ? -dx : dx, ay = dy < 0.0 ? -dy : dy;
      const bool in_disc = squared <= squared_radius;
      const bool in_square = (ax > ay ? ax : ay) <= radius;
      const bool inside = disc ? in_disc : in_square;
      const double t = (direction[i] - begin[i]) / width[i];
      const double along = (1.0 - t) * low[i] + t * high[i];                // (12)
      const double weight = exp_negative(0.5 * squared / (along * along));  // (11)
      omega[first + i] = inside ? weight : 0.0;
    }
  }
}

// Adds what the samples of piece (px, py) give to piece (x, y); omega: of its samples.
void add_piece(const FilterInput& input, const PlacedSamples& placed, int x, int y, std::size_t p,
               const double* omega, FilterWeighting weighting, PieceSums& sums) {
  const double count = input.n[p];
  const double share = weighting == FilterWeighting::kPerSample ? 1.0 : 1.0 / count;
  for (std::size_t s = placed.begin[p]; s < placed.begin[p + 1]; ++s) {
    const double w = omega[s - placed.begin[p]] * share;
    if (w == 0.0) continue;
    sums.total += w;
    for (std::size_t c = 0; c < 3; ++c) {
      sums.value[c] += w * (static_cast<double>(placed.radiance[s][c]) - input.mean[c](x, y));
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
    std::vector<double> delta(widths.beta.size()), omega;
    WidthLines lines(widths.beta);
    for (int x = 0; x < width; ++x) {
      const int k = input.level(x, y);
      if (k == 0) continue;
      for (std::size_t i = 0; i < delta.size(); ++i)
        delta[i] = static_cast<double>(widths.delta[i](x, y));
      lines.set(delta, options.eq12);
      const int radius = filter_radius(k);
      const Rectangle near =
          intersect({x - radius, y - radius, x + radius + 1, y + radius + 1}, input.level.bounds());
      const Window window{x + 0.5, y + 0.5, static_cast<double>(radius),
                          options.window == FilterWindow::kDisc};
      PieceSums sums;
      for (int py = near.y0; py < near.y1; ++py) {
        const std::size_t first = input.n.index(near.x0, py);
        const std::size_t begin = placed.begin[first];
        const std::size_t count =
            placed.begin[first + static_cast<std::size_t>(near.width())] - begin;
        omega.resize(std::max(omega.size(), count));
        sample_weights(placed.x.data() + begin, placed.y.data() + begin, static_cast<int>(count),
                       window, lines, omega.data());
        for (std::size_t p = first; p < first + static_cast<std::size_t>(near.width()); ++p) {
          add_piece(input, placed, x, y, p, omega.data() + (placed.begin[p] - begin),
                    options.weighting, sums);
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
