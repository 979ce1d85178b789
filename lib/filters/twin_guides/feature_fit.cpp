#include "lib/filters/twin_guides/feature_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kCut = 8.0;         // distance at which a weight is 0
constexpr std::size_t kMoments = 6;  // of the weights: 1, x, y, xx, xy, yy
constexpr std::size_t kSums = 4;     // of a channel: value, times x, times y, variance

// to[x] += one channel's normalised squared difference, less its expectation.
SPOOL_VECTOR_CLONES
void add_distance(const float* p, const float* v, std::ptrdiff_t shift, float slack, float tau,
                  int width, float* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const float d = p[x] - p[x + shift], vp = v[x], vq = v[x + shift];
    to[x] += (d * d - slack * (vp + (vq < vp ? vq : vp))) / (vp + vq + tau);
  }
}

// to[x] = from[x] + ... + from[x + (terms - 1) step], in that order.
SPOOL_VECTOR_CLONES
void sum_of(const float* from, std::ptrdiff_t step, int terms, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x)
    to[x] = from[x];
  for (int i = 1; i < terms; ++i) {
    for (int x = 0; x < width; ++x)
      to[x] += from[x + i * step];
  }
}

SPOOL_VECTOR_CLONES
void weights_of(const float* sum, const float* share, float spatial, float end, int width,
                float* __restrict weight) {
  for (int x = 0; x < width; ++x) {
    const float e = sum[x] * share[x];
    const float w = exp_negative((e > 0.0f ? e : 0.0f) + spatial) - end;
    weight[x] = w > 0.0f ? w : 0.0f;
  }
}

SPOOL_VECTOR_CLONES
void add_moments(const float* weight, float dx, float dy, std::ptrdiff_t plane, int width,
                 float* __restrict sums) {
  const std::array<float, kMoments> factors = {1.0f, dx, dy, dx * dx, dx * dy, dy * dy};
  for (std::size_t m = 0; m < kMoments; ++m) {
    float* to = sums + static_cast<std::ptrdiff_t>(m) * plane;
    for (int x = 0; x < width; ++x)
      to[x] += factors[m] * weight[x];
  }
}

// p: a channel's row, its variance a `plane` behind; q stands `shift` further.
SPOOL_VECTOR_CLONES
void add_channel(const float* weight, const float* p, const float* v, std::ptrdiff_t shift,
                 float dx, float dy, std::ptrdiff_t plane, int width, float* __restrict sums) {
  float *right = sums + plane, *down = right + plane, *variance = down + plane;
  for (int x = 0; x < width; ++x) {
    const float w = weight[x], wd = w * (p[x + shift] - p[x]);
    sums[x] += wd;
    right[x] += dx * wd;
    down[x] += dy * wd;
    variance[x] += w * w * v[x + shift];
  }
}

class TileFeatureFit {
 public:
  TileFeatureFit(const Rectangle& tile, const FeatureImages& features,
                 const FeatureFitOptions& options)
      : tile_(tile),
        image_(features.value[0].bounds()),
        options_(options),
        channels_(features.value.size()),
        width_(whole_vectors(tile.width())),
        features_(around(options.radius + options.patch), 2 * channels_),
        sums_(tile, kMoments + kSums * channels_),
        distance_(around(options.patch), 1),
        across_(around(options.patch), 1),
        share_(static_cast<std::size_t>(width_)),
        patch_(share_),
        weight_(share_) {
    for (std::size_t c = 0; c < channels_; ++c) {
      features_.copy_clamped(2 * c, features.value[c]);
      features_.copy_clamped(2 * c + 1, features.variance[c]);
    }
  }

  Blend run() {
    for (int dy = -options_.radius; dy <= options_.radius; ++dy) {
      for (int dx = -options_.radius; dx <= options_.radius; ++dx)
        add_offset(dx, dy);
    }
    Blend blend;
    blend.mean.assign(channels_, Image<float>(tile_.width(), tile_.height()));
    blend.variance = blend.mean;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int x = tile_.x0; x < tile_.x1; ++x)
        solve(x, y, blend);
    }
    return blend;
  }

 private:
  Rectangle around(int reach) const {
    return {tile_.x0 - reach, tile_.y0 - reach, tile_.x1 + reach, tile_.y1 + reach};
  }

  // Of the tile and the patch around it, 0 where p is outside the image.
  void distances(int dx, int dy) {
    const Rectangle& all = distance_.covered();
    const std::ptrdiff_t shift = dy * features_.stride() + dx;
    for (int y = all.y0; y < all.y1; ++y) {
      float* row = distance_.at(0, all.x0, y);
      std::fill_n(row, whole_vectors(all.width()), 0.0f);
      if (y < image_.y0 || y >= image_.y1) continue;
      for (std::size_t c = 0; c < channels_; ++c) {
        add_distance(features_.at(2 * c, all.x0, y), features_.at(2 * c + 1, all.x0, y), shift,
                     options_.slack, options_.tau, whole_vectors(all.width()), row);
      }
      if (all.x0 < image_.x0) std::fill_n(row, image_.x0 - all.x0, 0.0f);
      if (all.x1 > image_.x1) std::fill(row + (image_.x1 - all.x0), row + all.width(), 0.0f);
    }
  }

  // gain / (channels x pieces of the patch around each piece of row y that are inside the image).
  void share_of_patch(int y) {
    const int f = options_.patch;
    const int rows = std::min(y + f + 1, image_.y1) - std::max(y - f, image_.y0);
    for (int x = tile_.x0; x < tile_.x1; ++x) {
      const int columns = std::min(x + f + 1, image_.x1) - std::max(x - f, image_.x0);
      share_[static_cast<std::size_t>(x - tile_.x0)] =
          options_.gain / static_cast<float>(rows * columns * static_cast<int>(channels_));
    }
  }

  void add_offset(int dx, int dy) {
    const int f = options_.patch, side = 2 * f + 1;
    distances(dx, dy);
    const Rectangle& all = distance_.covered();
    for (int y = all.y0; y < all.y1; ++y)
      sum_of(distance_.at(0, all.x0, y), 1, side, width_, across_.at(0, all.x0, y));
    const auto spatial =
        static_cast<float>((dx * dx + dy * dy) / (2.0 * options_.sigma * options_.sigma));
    for (int y = std::max(tile_.y0, image_.y0 - dy); y < std::min(tile_.y1, image_.y1 - dy); ++y) {
      sum_of(across_.at(0, all.x0, y - f), across_.stride(), side, width_, patch_.data());
      share_of_patch(y);
      weights_of(patch_.data(), share_.data(), spatial, static_cast<float>(std::exp(-kCut)), width_,
                 weight_.data());
      for (int x = tile_.x0; x < std::min(tile_.x1, image_.x0 - dx); ++x)
        weight_[static_cast<std::size_t>(x - tile_.x0)] = 0.0f;
      for (int x = std::max(tile_.x0, image_.x1 - dx); x < tile_.x1; ++x)
        weight_[static_cast<std::size_t>(x - tile_.x0)] = 0.0f;
      add_row(dx, dy, y);
    }
  }

  void add_row(int dx, int dy, int y) {
    const float right = static_cast<float>(dx) / static_cast<float>(options_.radius);
    const float down = static_cast<float>(dy) / static_cast<float>(options_.radius);
    const std::ptrdiff_t plane = sums_.at(1, tile_.x0, y) - sums_.at(0, tile_.x0, y);
    const std::ptrdiff_t shift = dy * features_.stride() + dx;
    add_moments(weight_.data(), right, down, plane, width_, sums_.at(0, tile_.x0, y));
    for (std::size_t c = 0; c < channels_; ++c) {
      add_channel(weight_.data(), features_.at(2 * c, tile_.x0, y),
                  features_.at(2 * c + 1, tile_.x0, y), shift, right, down, plane, width_,
                  sums_.at(kMoments + kSums * c, tile_.x0, y));
    }
  }

  void solve(int x, int y, Blend& blend) const {
    const auto sum = [&](std::size_t plane) { return *sums_.at(plane, x, y); };
    const float total = sum(0), wx = sum(1), wy = sum(2), xy = sum(4);
    const float xx = sum(3) + options_.ridge, yy = sum(5) + options_.ridge;
    const float determinant = xx * yy - xy * xy;
    const float a = (wx * yy - wy * xy) / determinant, b = (wy * xx - wx * xy) / determinant;
    const float divisor = total - a * wx - b * wy;  // at least the weight of the piece itself
    for (std::size_t c = 0; c < channels_; ++c) {
      const std::size_t first = kMoments + kSums * c;
      const float fitted = (sum(first) - a * sum(first + 1) - b * sum(first + 2)) / divisor;
      blend.mean[c](x - tile_.x0, y - tile_.y0) = *features_.at(2 * c, x, y) + fitted;
      blend.variance[c](x - tile_.x0, y - tile_.y0) = sum(first + 3) / (total * total);
    }
  }

  Rectangle tile_, image_;
  const FeatureFitOptions& options_;
  std::size_t channels_;
  int width_;
  TilePlanes features_;                        // value and variance of each channel in turn
  TilePlanes sums_;                            // moments of the weights, then kSums of each channel
  TilePlanes distance_, across_;               // e, and its sums along rows
  std::vector<float> share_, patch_, weight_;  // of the row at hand
};

}  // namespace

Blend feature_fit(const Rectangle& tile, const FeatureImages& features,
                  const FeatureFitOptions& options) {
  return TileFeatureFit(tile, features, options).run();
}

}  // namespace spool
