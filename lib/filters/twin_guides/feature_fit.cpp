#include "lib/filters/twin_guides/feature_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "lib/core/eight_floats.h"
#include "lib/core/exponential.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kCut = 8.0;         // distance at which a weight is 0
constexpr std::size_t kMoments = 6;  // of the weights: 1, x, y, xx, xy, yy
constexpr std::size_t kSums = 4;     // of a channel: value, times x, times y, variance

// Value and variance of each channel in turn, `plane` floats apart, from a row's first piece on.
struct Channels {
  const float* first;
  std::ptrdiff_t plane;
  std::size_t count;
};

// The sum over channels of normalised squared differences, less their expectation; q stands `shift`
// further.
template <class Vector>
[[gnu::always_inline]] inline void distances_of(const Channels& channels, std::ptrdiff_t shift,
                                                const FeatureFitOptions& options, int width,
                                                float* __restrict to) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector sum{}, p, q, v, u;
    for (std::size_t c = 0; c < channels.count; ++c) {
      const float* at = channels.first + 2 * static_cast<std::ptrdiff_t>(c) * channels.plane + x;
      std::memcpy(&p, at, sizeof(Vector));
      std::memcpy(&q, at + shift, sizeof(Vector));
      std::memcpy(&v, at + channels.plane, sizeof(Vector));
      std::memcpy(&u, at + channels.plane + shift, sizeof(Vector));
      const Vector d = p - q, smaller = u < v ? u : v;
      sum += (d * d - options.slack * (v + smaller)) / (v + u + options.tau);
    }
    std::memcpy(to + x, &sum, sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void distances(const Channels& channels, std::ptrdiff_t shift,
                                   const FeatureFitOptions& options, int width, float* to),
                    distances_of<Vector>(channels, shift, options, width, to))

// to[x] = from[x] + ... + from[x + terms - 1], in that order.
SPOOL_VECTOR_CLONES
void sum_across(const float* from, int terms, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x)
    to[x] = from[x];
  for (int i = 1; i < terms; ++i) {
    for (int x = 0; x < width; ++x)
      to[x] += from[x + i];
  }
}

SPOOL_VECTOR_CLONES
void add_row(const float* from, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x)
    to[x] += from[x];
}

SPOOL_VECTOR_CLONES
void weights_of(const float* share, float spatial, float end, int width, float* __restrict sum) {
  for (int x = 0; x < width; ++x) {
    const float e = sum[x] * share[x];
    const float w = exp_negative((e > 0.0f ? e : 0.0f) + spatial) - end;
    sum[x] = w > 0.0f ? w : 0.0f;
  }
}

// A neighbour of the pieces of a row: in the window, `right` and `down` in radii, and in memory.
struct Tap {
  float right, down;
  std::ptrdiff_t shift;
  const float* weight;  // [x]
};

// Moments of the weights, then kSums of each channel, a row of `width` of each.
template <class Vector>
[[gnu::always_inline]] inline void sums_of(const std::vector<Tap>& taps, const Channels& channels,
                                           int width, float* __restrict to) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector moment[kMoments] = {}, w;
    for (const Tap& tap : taps) {
      std::memcpy(&w, tap.weight + x, sizeof(Vector));
      moment[0] += w;
      moment[1] += tap.right * w;
      moment[2] += tap.down * w;
      moment[3] += tap.right * tap.right * w;
      moment[4] += tap.right * tap.down * w;
      moment[5] += tap.down * tap.down * w;
    }
    float* sum = to + x;
    for (std::size_t m = 0; m < kMoments; ++m, sum += width)
      std::memcpy(sum, &moment[m], sizeof(Vector));
    for (std::size_t c = 0; c < channels.count; ++c) {
      const float* at = channels.first + 2 * static_cast<std::ptrdiff_t>(c) * channels.plane + x;
      Vector s[kSums] = {}, p, q, u;
      std::memcpy(&p, at, sizeof(Vector));
      for (const Tap& tap : taps) {
        std::memcpy(&w, tap.weight + x, sizeof(Vector));
        std::memcpy(&q, at + tap.shift, sizeof(Vector));
        std::memcpy(&u, at + channels.plane + tap.shift, sizeof(Vector));
        const Vector wd = w * (q - p);
        s[0] += wd;
        s[1] += tap.right * wd;
        s[2] += tap.down * wd;
        s[3] += w * w * u;
      }
      for (std::size_t k = 0; k < kSums; ++k, sum += width)
        std::memcpy(sum, &s[k], sizeof(Vector));
    }
  }
}

SPOOL_VECTOR_WIDTHS(void sums(const std::vector<Tap>& taps, const Channels& channels, int width,
                              float* to),
                    sums_of<Vector>(taps, channels, width, to))

class TileFeatureFit {
 public:
  TileFeatureFit(const Rectangle& tile, const FeatureImages& features,
                 const FeatureFitOptions& options)
      : tile_(tile),
        image_(features.value[0].bounds()),
        options_(options),
        channels_(features.value.size()),
        width_(whole_vectors(tile.width())),
        side_(2 * options.patch + 1),
        features_(around(options.radius + options.patch), 2 * channels_),
        distance_(around(options.patch), 1),
        across_({tile.x0, 0, tile.x1, side_}, offsets()),
        weights_({tile.x0, 0, tile.x1, 1}, offsets()),
        sums_((kMoments + kSums * channels_) * static_cast<std::size_t>(width_)),
        share_(static_cast<std::size_t>(width_)) {
    for (std::size_t c = 0; c < channels_; ++c) {
      features_.copy_clamped(2 * c, features.value[c]);
      features_.copy_clamped(2 * c + 1, features.variance[c]);
    }
  }

  // Row by row with all offsets, so that sums stay in registers.
  Blend run() {
    Blend blend;
    blend.mean.assign(channels_, Image<float>(tile_.width(), tile_.height()));
    blend.variance = blend.mean;
    const int f = options_.patch;
    for (int y = tile_.y0 - f; y < tile_.y0 + f; ++y)
      measure(y);
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      measure(y + f);
      weigh(y);
      sums(taps_, channels(tile_.x0, y), width_, sums_.data());
      for (int x = tile_.x0; x < tile_.x1; ++x)
        solve(x, y, blend);
    }
    return blend;
  }

 private:
  Rectangle around(int reach) const {
    return {tile_.x0 - reach, tile_.y0 - reach, tile_.x1 + reach, tile_.y1 + reach};
  }
  std::size_t offsets() const {
    return static_cast<std::size_t>((2 * options_.radius + 1) * (2 * options_.radius + 1));
  }
  Channels channels(int x, int y) const {
    return {features_.at(0, x, y), features_.at(1, x, y) - features_.at(0, x, y), channels_};
  }
  template <class Visit>
  void visit_offsets(Visit&& visit) const {
    std::size_t o = 0;
    for (int dy = -options_.radius; dy <= options_.radius; ++dy) {
      for (int dx = -options_.radius; dx <= options_.radius; ++dx)
        visit(o++, dx, dy);
    }
  }
  // Where sums over the patch's row y are kept.
  float* across(std::size_t offset, int y) {
    return across_.at(offset, tile_.x0, (y - tile_.y0 + options_.patch) % side_);
  }

  // Distances of row y at all offsets, 0 where p is outside the image, summed over the patch's
  // width.
  void measure(int y) {
    const Rectangle& all = distance_.covered();
    const int width = whole_vectors(all.width());
    float* row = distance_.at(0, all.x0, all.y0);
    visit_offsets([&](std::size_t o, int dx, int dy) {
      if (y < image_.y0 || y >= image_.y1) {
        std::fill_n(across(o, y), width_, 0.0f);
        return;
      }
      distances(channels(all.x0, y), dy * features_.stride() + dx, options_, width, row);
      if (all.x0 < image_.x0) std::fill_n(row, image_.x0 - all.x0, 0.0f);
      if (all.x1 > image_.x1) std::fill(row + (image_.x1 - all.x0), row + all.width(), 0.0f);
      sum_across(row, side_, width_, across(o, y));
    });
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

  // The taps of row y that are inside the image, with their weights.
  void weigh(int y) {
    share_of_patch(y);
    taps_.clear();
    const auto end = static_cast<float>(std::exp(-kCut));
    const auto radius = static_cast<float>(options_.radius);
    visit_offsets([&](std::size_t o, int dx, int dy) {
      if (y + dy < image_.y0 || y + dy >= image_.y1) return;
      float* weight = weights_.at(o, tile_.x0, 0);
      std::copy_n(across(o, y - options_.patch), width_, weight);
      for (int j = 1 - options_.patch; j <= options_.patch; ++j)
        add_row(across(o, y + j), width_, weight);
      const auto spatial =
          static_cast<float>((dx * dx + dy * dy) / (2.0 * options_.sigma * options_.sigma));
      weights_of(share_.data(), spatial, end, width_, weight);
      for (int x = tile_.x0; x < std::min(tile_.x1, image_.x0 - dx); ++x)
        weight[x - tile_.x0] = 0.0f;
      for (int x = std::max(tile_.x0, image_.x1 - dx); x < tile_.x1; ++x)
        weight[x - tile_.x0] = 0.0f;
      taps_.push_back({static_cast<float>(dx) / radius, static_cast<float>(dy) / radius,
                       dy * features_.stride() + dx, weight});
    });
  }

  void solve(int x, int y, Blend& blend) const {
    const auto sum = [&](std::size_t plane) {
      return sums_[plane * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(x - tile_.x0)];
    };
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
  int width_, side_;     // of the tile in whole vectors; of the patch
  TilePlanes features_;  // value and variance of each channel in turn
  TilePlanes distance_;  // of the row at hand
  TilePlanes across_;    // [offset] its sums along the last rows, as many as a patch has
  TilePlanes weights_;   // [offset] of the row at hand
  std::vector<Tap> taps_;
  std::vector<float> sums_, share_;  // of the row at hand
};

}  // namespace

Blend feature_fit(const Rectangle& tile, const FeatureImages& features,
                  const FeatureFitOptions& options) {
  return TileFeatureFit(tile, features, options).run();
}

}  // namespace spool
