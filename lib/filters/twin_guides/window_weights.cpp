#include "lib/filters/twin_guides/window_weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lib/core/eight_floats.h"
#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr float kFeatureTau = 1e-2f;
constexpr std::size_t kTogether = 4;  // channels with one division; kGuideChannels is a multiple

// A stack of planes: value and variance in turn, `plane` floats apart; q stands `shift` further.
struct Rows {
  const float* first = nullptr;
  std::ptrdiff_t plane = 0, shift = 0;
  std::size_t channels = 0;
};

// to = spatial + gain max(0, max_c ((p - q)^2 - V) / (V + kFeatureTau)): compared crosswise, so
// that one quotient is left.
template <class Vector>
[[gnu::always_inline]] inline void feature_distances_of(const Rows& rows, float spatial, float gain,
                                                        int width, float* __restrict to) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector numerator{}, denominator = Vector{} + 1.0f, p, q, v, u;
    const float* at = rows.first + x;
    for (std::size_t c = 0; c < rows.channels; ++c, at += 2 * rows.plane) {
      std::memcpy(&p, at, sizeof(Vector));
      std::memcpy(&q, at + rows.shift, sizeof(Vector));
      std::memcpy(&v, at + rows.plane, sizeof(Vector));
      std::memcpy(&u, at + rows.plane + rows.shift, sizeof(Vector));
      const Vector d = p - q, sum = v + u;
      const Vector a = d * d - sum, b = sum + kFeatureTau;
      const auto larger = a * denominator > numerator * b;
      numerator = larger ? a : numerator;
      denominator = larger ? b : denominator;
    }
    const Vector distance = spatial + gain * (numerator / denominator);
    std::memcpy(to + x, &distance, sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void feature_distances(const Rows& rows, float spatial, float gain, int width,
                                           float* to),
                    feature_distances_of<Vector>(rows, spatial, gain, width, to))

// One channel of max(0, (p - q)^2 - U) / (U + tau2), not yet divided.
template <class Vector>
[[gnu::always_inline]] inline void guide_distance(const Rows& rows, const float* at, float tau2,
                                                  Vector& a, Vector& b) {
  Vector p, q, v, u;
  std::memcpy(&p, at, sizeof(Vector));
  std::memcpy(&q, at + rows.shift, sizeof(Vector));
  std::memcpy(&v, at + rows.plane, sizeof(Vector));
  std::memcpy(&u, at + rows.plane + rows.shift, sizeof(Vector));
  const Vector d = p - q, sum = v + u, e = d * d - sum;
  a = e > 0.0f ? e : Vector{};
  b = sum + tau2;
}

// to += share times the sum over all channels, four of them with one division.
template <class Vector>
[[gnu::always_inline]] inline void add_guide_distances_of(const Rows& rows, float tau2, float share,
                                                          int width, float* __restrict to) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector sum{}, z;
    for (std::size_t c = 0; c < kGuideChannels; c += kTogether) {
      const float* at = rows.first + x + 2 * static_cast<std::ptrdiff_t>(c) * rows.plane;
      Vector a0, a1, a2, a3, b0, b1, b2, b3;
      guide_distance(rows, at, tau2, a0, b0);
      guide_distance(rows, at + 2 * rows.plane, tau2, a1, b1);
      guide_distance(rows, at + 4 * rows.plane, tau2, a2, b2);
      guide_distance(rows, at + 6 * rows.plane, tau2, a3, b3);
      const Vector b01 = b0 * b1, b23 = b2 * b3;
      sum += ((a0 * b1 + a1 * b0) * b23 + (a2 * b3 + a3 * b2) * b01) / (b01 * b23);
    }
    std::memcpy(&z, to + x, sizeof(Vector));
    z += share * sum;
    std::memcpy(to + x, &z, sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void add_guide_distances(const Rows& rows, float tau2, float share, int width,
                                             float* to),
                    add_guide_distances_of<Vector>(rows, tau2, share, width, to))

SPOOL_VECTOR_CLONES
void weights_of_distances(float end, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const float w = exp_negative(to[x]) - end;
    to[x] = w > 0.0f ? w : 0.0f;
  }
}

struct Terms {
  float spatial, feature_gain, guide_share, end, tau2;
};

// The weights of a row, `width` of them. Three short loops: the processor works on several turns of
// each at a time, where one long chain of operations would make it wait.
void weights_of(const Rows& features, const Rows& guides, const Terms& terms, int width,
                float* to) {
  feature_distances(features, terms.spatial, terms.feature_gain, width, to);
  add_guide_distances(guides, terms.tau2, terms.guide_share, width, to);
  weights_of_distances(terms.end, width, to);
}

struct WeightedRow {
  const float *weight, *value;
};

std::vector<WeightedRow> weighted_rows(const WindowWeights& weights, const TilePlanes& values,
                                       std::size_t plane, int x, int y) {
  std::vector<WeightedRow> rows;
  rows.reserve(weights.offsets().size());
  for (std::size_t o = 0; o < weights.offsets().size(); ++o) {
    const auto [dx, dy] = weights.offsets()[o];
    rows.push_back({weights.row(o, x, y), values.at(plane, x + dx, y + dy)});
  }
  return rows;
}

template <class Vector>
[[gnu::always_inline]] inline void sums_of(const std::vector<WeightedRow>& rows, int width,
                                           float* __restrict sum, float* __restrict total) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector s{}, t{}, w, v;
    for (const WeightedRow& row : rows) {
      std::memcpy(&w, row.weight + x, sizeof(Vector));
      std::memcpy(&v, row.value + x, sizeof(Vector));
      s += w * v;
      t += w;
    }
    std::memcpy(sum + x, &s, sizeof(Vector));
    std::memcpy(total + x, &t, sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void add_rows(const std::vector<WeightedRow>& rows, int width, float* sum,
                                  float* total),
                    sums_of<Vector>(rows, width, sum, total))

template <class Vector>
[[gnu::always_inline]] inline void deviations_of(const std::vector<WeightedRow>& rows, int width,
                                                 const float* mean, float* __restrict sum) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector s{}, m, w, v;
    std::memcpy(&m, mean + x, sizeof(Vector));
    for (const WeightedRow& row : rows) {
      std::memcpy(&w, row.weight + x, sizeof(Vector));
      std::memcpy(&v, row.value + x, sizeof(Vector));
      const Vector d = w * (v - m);
      s += d * d;
    }
    std::memcpy(sum + x, &s, sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void add_deviations(const std::vector<WeightedRow>& rows, int width,
                                        const float* mean, float* sum),
                    deviations_of<Vector>(rows, width, mean, sum))

Rectangle before(const Rectangle& tile, int radius) {
  return {tile.x0 - radius, tile.y0 - radius, tile.x1 + radius, tile.y1};
}

std::size_t half_of_window(int radius) {
  return 2 * static_cast<std::size_t>(radius) * static_cast<std::size_t>(radius + 1);
}

}  // namespace

WindowWeights::WindowWeights(const Lattice& lattice, const Rectangle& tile,
                             const WindowShape& shape, const GuidePyramid& pyramid,
                             const FeatureImages& features, const TwinGuidesOptions& options)
    : radius_(shape.radius), planes_(before(tile, shape.radius), half_of_window(shape.radius) + 1) {
  const int r = shape.radius;
  for (int dy = -r; dy <= r; ++dy) {
    for (int dx = -r; dx <= r; ++dx)
      offsets_.push_back({dx, dy});
  }
  const Rectangle around = {tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r};
  TilePlanes clean(around, 2 * features.value.size());
  for (std::size_t c = 0; c < features.value.size(); ++c) {
    clean.copy_clamped(2 * c, features.value[c], lattice);
    clean.copy_clamped(2 * c + 1, features.variance[c], lattice);
  }
  compute(tile, pyramid.guides(lattice, around), clean, features.value.size(), lattice.bounds(),
          shape.sigma, options);
}

void WindowWeights::compute(const Rectangle& tile, const TilePlanes& guides,
                            const TilePlanes& features, std::size_t channels,
                            const Rectangle& image, double sigma,
                            const TwinGuidesOptions& options) {
  const Rectangle& all = planes_.covered();
  const int width = whole_vectors(all.width());
  const double cut = options.cut;
  Terms terms{0.0f, static_cast<float>(options.feature_gain),
              1.0f / static_cast<float>(kGuideChannels), static_cast<float>(std::exp(-cut)),
              static_cast<float>(options.tau * options.tau)};
  const std::size_t half = half_of_window(radius_);
  const auto rows_of = [&](const TilePlanes& planes, std::size_t count, const Offset& to, int y) {
    if (count == 0) return Rows{};
    return Rows{planes.at(0, all.x0, y), planes.at(1, all.x0, y) - planes.at(0, all.x0, y),
                to.dy * planes.stride() + to.dx, count};
  };
  for (int y = all.y0; y < tile.y1; ++y) {  // outside: an offset's rows stay in the first cache
    for (std::size_t o = half; o < offsets_.size(); ++o) {
      const auto [dx, dy] = offsets_[o];
      float* to = planes_.at(o - half, all.x0, y);
      // A piece before the tile is wanted with pieces of the tile only.
      if (y < image.y0 || y + dy >= image.y1 || y + dy < tile.y0) {
        std::fill_n(to, all.width(), 0.0f);
        continue;
      }
      terms.spatial = static_cast<float>((dx * dx + dy * dy) / (2.0 * sigma * sigma));
      weights_of(rows_of(features, channels, offsets_[o], y),
                 rows_of(guides, kGuideChannels, offsets_[o], y), terms, width, to);
      const int x0 = std::max({all.x0, image.x0, image.x0 - dx});
      const int x1 = std::max(x0, std::min({all.x1, image.x1, image.x1 - dx}));
      std::fill(to, to + (x0 - all.x0), 0.0f);
      std::fill(to + (x1 - all.x0), to + all.width(), 0.0f);
    }
  }
}

const float* WindowWeights::row(std::size_t offset, int x, int y) const {
  const std::size_t half = offsets_.size() / 2;
  if (offset >= half) return planes_.at(offset - half, x, y);
  const auto [dx, dy] = offsets_[offset];  // w of the pair, kept where its other end comes first
  return planes_.at(half - offset, x + dx, y + dy);
}

void WindowWeights::sum(const TilePlanes& values, std::size_t plane, int x, int y, int width,
                        float* sum, float* total) const {
  add_rows(weighted_rows(*this, values, plane, x, y), width, sum, total);
}

void WindowWeights::squared_deviations(const TilePlanes& values, std::size_t plane, int x, int y,
                                       int width, const float* mean, float* sum) const {
  add_deviations(weighted_rows(*this, values, plane, x, y), width, mean, sum);
}

}  // namespace spool
