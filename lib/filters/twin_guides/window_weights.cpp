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

// max(0, max_c ((p - q)^2 - V) / (V + kFeatureTau)) of eight pieces: compared crosswise, so that
// one quotient is left.
[[gnu::always_inline]] inline void feature_distance(const Rows& rows, int x, Eight& distance) {
  Eight numerator{}, denominator = Eight{} + 1.0f, p, q, v, u;
  const float* at = rows.first + x;
  for (std::size_t c = 0; c < rows.channels; ++c, at += 2 * rows.plane) {
    std::memcpy(&p, at, sizeof(Eight));
    std::memcpy(&q, at + rows.shift, sizeof(Eight));
    std::memcpy(&v, at + rows.plane, sizeof(Eight));
    std::memcpy(&u, at + rows.plane + rows.shift, sizeof(Eight));
    const Eight d = p - q, sum = v + u;
    const Eight a = d * d - sum, b = sum + kFeatureTau;
    const auto larger = a * denominator > numerator * b;
    numerator = larger ? a : numerator;
    denominator = larger ? b : denominator;
  }
  distance = numerator / denominator;
}

// One channel of max(0, (p - q)^2 - U) / (U + tau2), not yet divided.
[[gnu::always_inline]] inline void guide_distance(const Rows& rows, const float* at, float tau2,
                                                  Eight& a, Eight& b) {
  Eight p, q, v, u;
  std::memcpy(&p, at, sizeof(Eight));
  std::memcpy(&q, at + rows.shift, sizeof(Eight));
  std::memcpy(&v, at + rows.plane, sizeof(Eight));
  std::memcpy(&u, at + rows.plane + rows.shift, sizeof(Eight));
  const Eight d = p - q, sum = v + u, e = d * d - sum;
  a = e > 0.0f ? e : Eight{};
  b = sum + tau2;
}

// The sum over all channels, four of them with one division.
[[gnu::always_inline]] inline void guide_distances(const Rows& rows, float tau2, int x, Eight& z) {
  z = Eight{};
  for (std::size_t c = 0; c < kGuideChannels; c += kTogether) {
    const float* at = rows.first + x + 2 * static_cast<std::ptrdiff_t>(c) * rows.plane;
    Eight a0, a1, a2, a3, b0, b1, b2, b3;
    guide_distance(rows, at, tau2, a0, b0);
    guide_distance(rows, at + 2 * rows.plane, tau2, a1, b1);
    guide_distance(rows, at + 4 * rows.plane, tau2, a2, b2);
    guide_distance(rows, at + 6 * rows.plane, tau2, a3, b3);
    const Eight b01 = b0 * b1, b23 = b2 * b3;
    z += ((a0 * b1 + a1 * b0) * b23 + (a2 * b3 + a3 * b2) * b01) / (b01 * b23);
  }
}

struct Terms {
  float spatial, feature_gain, guide_share, end, tau2;
};

// The weights of a row, `width` of them, a multiple of eight.
SPOOL_VECTOR_CLONES
void weights_of(const Rows& features, const Rows& guides, const Terms& terms, int width,
                float* __restrict to) {
  for (int x = 0; x < width; x += kEight) {
    Eight distance, z;
    feature_distance(features, x, distance);
    guide_distances(guides, terms.tau2, x, z);
    z = terms.spatial + terms.feature_gain * distance + terms.guide_share * z;
    float w[kEight];
    std::memcpy(w, &z, sizeof(w));
    for (float& each : w)
      each = exp_negative(each);
    std::memcpy(&z, w, sizeof(w));
    z -= terms.end;
    z = z > 0.0f ? z : Eight{};
    std::memcpy(to + x, &z, sizeof(Eight));
  }
}

Rectangle before(const Rectangle& tile, int radius) {
  return {tile.x0 - radius, tile.y0 - radius, tile.x1 + radius, tile.y1};
}

std::size_t half_of_window(int radius) {
  return static_cast<std::size_t>(2 * radius * (radius + 1));
}

}  // namespace

WindowWeights::WindowWeights(const Lattice& lattice, const Rectangle& tile,
                             const WindowShape& shape, const GuideImages& guides,
                             const FeatureImages& features, const TwinGuidesOptions& options)
    : radius_(shape.radius), planes_(before(tile, shape.radius), half_of_window(shape.radius) + 1) {
  const int r = shape.radius;
  for (int dy = -r; dy <= r; ++dy) {
    for (int dx = -r; dx <= r; ++dx)
      offsets_.push_back({dx, dy});
  }
  const Rectangle around = {tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r};
  const auto planes_of = [&](const std::vector<Image<float>>& values,
                             const std::vector<Image<float>>& variances) {
    TilePlanes planes(around, 2 * values.size());
    for (std::size_t c = 0; c < values.size(); ++c) {
      planes.copy_clamped(2 * c, values[c], lattice);
      planes.copy_clamped(2 * c + 1, variances[c], lattice);
    }
    return planes;
  };
  compute(tile, planes_of(guides.value, guides.variance),
          planes_of(features.value, features.variance), features.value.size(), lattice.bounds(),
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
  for (std::size_t o = half; o < offsets_.size(); ++o) {
    const auto [dx, dy] = offsets_[o];
    terms.spatial = static_cast<float>((dx * dx + dy * dy) / (2.0 * sigma * sigma));
    for (int y = all.y0; y < tile.y1; ++y) {
      float* to = planes_.at(o - half, all.x0, y);
      const int x0 = std::max({all.x0, image.x0, image.x0 - dx});
      const int x1 = std::max(x0, std::min({all.x1, image.x1, image.x1 - dx}));
      // A piece before the tile is wanted with pieces of the tile only.
      if (y < image.y0 || y + dy >= image.y1 || y + dy < tile.y0) {
        std::fill_n(to, all.width(), 0.0f);
        continue;
      }
      const auto rows_of = [&](const TilePlanes& planes, std::size_t count) {
        if (count == 0) return Rows{};
        return Rows{planes.at(0, all.x0, y), planes.at(1, all.x0, y) - planes.at(0, all.x0, y),
                    dy * planes.stride() + dx, count};
      };
      weights_of(rows_of(features, channels), rows_of(guides, kGuideChannels), terms, width, to);
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

}  // namespace spool
