#include "lib/filters/twin_guides/window_weights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr float kFeatureTau = 1e-2f;
constexpr std::size_t kTogether = 4;  // channels with one division; kGuideChannels is a multiple

// A stack of planes: value and variance in turn, `plane` floats apart; q stands `shift` further.
struct Rows {
  const float* first;
  std::ptrdiff_t plane, shift;
  std::size_t channels;
};

// max(0, max_c ((p - q)^2 - V) / (V + kFeatureTau)) as a quotient, which is compared crosswise.
SPOOL_VECTOR_CLONES
void feature_distances(const Rows& rows, int width, float* __restrict numerator,
                       float* __restrict denominator) {
  for (int x = 0; x < width; ++x) {
    numerator[x] = 0.0f;
    denominator[x] = 1.0f;
  }
  for (std::size_t c = 0; c < rows.channels; ++c) {
    const float* p = rows.first + 2 * static_cast<std::ptrdiff_t>(c) * rows.plane;
    const float *v = p + rows.plane, *q = p + rows.shift, *u = v + rows.shift;
    for (int x = 0; x < width; ++x) {
      const float d = p[x] - q[x], sum = v[x] + u[x];
      const float a = d * d - sum, b = sum + kFeatureTau;
      const bool larger = a * denominator[x] > numerator[x] * b;
      numerator[x] = larger ? a : numerator[x];
      denominator[x] = larger ? b : denominator[x];
    }
  }
}

// z[x] += max(0, (p - q)^2 - U) / (U + tau2) of four channels, with one division for them all.
SPOOL_VECTOR_CLONES
void add_guide_distances(const Rows& rows, float tau2, int width, float* __restrict z) {
  const float *p0 = rows.first, *p1 = p0 + 2 * rows.plane, *p2 = p1 + 2 * rows.plane,
              *p3 = p2 + 2 * rows.plane;
  const std::ptrdiff_t plane = rows.plane, shift = rows.shift;
  for (int x = 0; x < width; ++x) {
    const float d0 = p0[x] - p0[x + shift], d1 = p1[x] - p1[x + shift];
    const float d2 = p2[x] - p2[x + shift], d3 = p3[x] - p3[x + shift];
    const float u0 = p0[x + plane] + p0[x + plane + shift];
    const float u1 = p1[x + plane] + p1[x + plane + shift];
    const float u2 = p2[x + plane] + p2[x + plane + shift];
    const float u3 = p3[x + plane] + p3[x + plane + shift];
    const float e0 = d0 * d0 - u0, e1 = d1 * d1 - u1, e2 = d2 * d2 - u2, e3 = d3 * d3 - u3;
    const float a0 = e0 > 0.0f ? e0 : 0.0f, a1 = e1 > 0.0f ? e1 : 0.0f;
    const float a2 = e2 > 0.0f ? e2 : 0.0f, a3 = e3 > 0.0f ? e3 : 0.0f;
    const float b0 = u0 + tau2, b1 = u1 + tau2, b2 = u2 + tau2, b3 = u3 + tau2;
    const float b01 = b0 * b1, b23 = b2 * b3;
    z[x] += ((a0 * b1 + a1 * b0) * b23 + (a2 * b3 + a3 * b2) * b01) / (b01 * b23);
  }
}

struct Terms {
  float spatial, feature_gain, guide_share, end;
};

SPOOL_VECTOR_CLONES
void weights_of(const float* z, const float* numerator, const float* denominator,
                const Terms& terms, int width, float* __restrict to) {
  const float spatial = terms.spatial, gain = terms.feature_gain, share = terms.guide_share,
              end = terms.end;
  for (int x = 0; x < width; ++x) {
    const float w =
        exp_negative(spatial + gain * (numerator[x] / denominator[x]) + share * z[x]) - end;
    to[x] = w > 0.0f ? w : 0.0f;
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
  std::vector<float> z(static_cast<std::size_t>(width)), numerator(z), denominator(z);
  const double cut = options.cut;
  Terms terms{0.0f, static_cast<float>(options.feature_gain),
              1.0f / static_cast<float>(kGuideChannels), static_cast<float>(std::exp(-cut))};
  const auto tau2 = static_cast<float>(options.tau * options.tau);
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
      const auto rows_of = [&](const TilePlanes& planes, std::size_t plane, std::size_t count) {
        return Rows{planes.at(plane, all.x0, y), planes.at(1, all.x0, y) - planes.at(0, all.x0, y),
                    dy * planes.stride() + dx, count};
      };
      feature_distances(channels == 0 ? Rows{nullptr, 0, 0, 0} : rows_of(features, 0, channels),
                        width, numerator.data(), denominator.data());
      std::fill(z.begin(), z.end(), 0.0f);
      for (std::size_t c = 0; c < kGuideChannels; c += kTogether)
        add_guide_distances(rows_of(guides, 2 * c, kTogether), tau2, width, z.data());
      weights_of(z.data(), numerator.data(), denominator.data(), terms, width, to);
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
