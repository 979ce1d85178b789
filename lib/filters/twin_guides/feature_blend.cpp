#include "lib/filters/twin_guides/feature_blend.h"

#include <algorithm>
#include <cmath>

#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kCut = 8.0;  // distance at which a weight is 0

// The largest quotient so far, as numerator and denominator: comparing crosswise saves a division.
// p: value and variance of a channel's row; q stands `shift` floats further.
SPOOL_VECTOR_CLONES
void raise_distance(const float* p, const float* v, std::ptrdiff_t shift, float tau, int width,
                    float* __restrict numerator, float* __restrict denominator) {
  for (int x = 0; x < width; ++x) {
    const float d = p[x] - p[x + shift], vp = v[x], vq = v[x + shift];
    const float a = d * d - (vp + (vq < vp ? vq : vp)), b = vp + vq + tau;
    const bool larger = a * denominator[x] > numerator[x] * b;
    numerator[x] = larger ? a : numerator[x];
    denominator[x] = larger ? b : denominator[x];
  }
}

SPOOL_VECTOR_CLONES
void weights_of(const float* numerator, const float* denominator, float spatial, float end,
                int width, float* __restrict weight) {
  for (int x = 0; x < width; ++x) {
    const float w = exp_negative(numerator[x] / denominator[x] + spatial) - end;
    weight[x] = w > 0.0f ? w : 0.0f;
  }
}

SPOOL_VECTOR_CLONES
void add_products(const float* weight, const float* value, int width, float* __restrict sum) {
  for (int x = 0; x < width; ++x)
    sum[x] += weight[x] * value[x];
}

SPOOL_VECTOR_CLONES
void square(float* __restrict row, int width) {
  for (int x = 0; x < width; ++x)
    row[x] *= row[x];
}

SPOOL_VECTOR_CLONES
void add_row(const float* value, int width, float* __restrict sum) {
  for (int x = 0; x < width; ++x)
    sum[x] += value[x];
}

class TileBlend {
 public:
  TileBlend(const Rectangle& tile, std::span<const Image<float>* const> values,
            std::span<const Image<float>* const> variances, const FeatureImages& features,
            const BlendOptions& options)
      : tile_(tile),
        image_(values[0]->bounds()),
        options_(options),
        means_(values.size()),
        squares_(variances.size()),
        channels_(features.value.size()),
        width_(whole_vectors(tile.width())),
        features_(around(options.radius), 2 * channels_),
        inputs_(around(options.radius), means_ + squares_),
        sums_(tile, means_ + squares_ + 1),
        numerator_(static_cast<std::size_t>(width_)),
        denominator_(numerator_),
        weight_(numerator_) {
    sums_.clear();
    for (std::size_t c = 0; c < channels_; ++c) {
      features_.copy_clamped(2 * c, features.value[c]);
      features_.copy_clamped(2 * c + 1, features.variance[c]);
    }
    for (std::size_t i = 0; i < means_; ++i)
      inputs_.copy_clamped(i, *values[i]);
    for (std::size_t i = 0; i < squares_; ++i)
      inputs_.copy_clamped(means_ + i, *variances[i]);
  }

  Blend run() {
    const int r = options_.radius;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx)
        add_offset(dx, dy);
    }
    Blend blend;
    for (std::size_t i = 0; i < means_ + squares_; ++i) {
      Image<float> image(tile_.width(), tile_.height());
      for (int y = tile_.y0; y < tile_.y1; ++y) {
        const float *sum = sums_.at(i, tile_.x0, y), *total = this->total(y);
        for (int x = 0; x < tile_.width(); ++x)
          image(x, y - tile_.y0) = i < means_ ? sum[x] / total[x] : sum[x] / (total[x] * total[x]);
      }
      (i < means_ ? blend.mean : blend.variance).push_back(std::move(image));
    }
    return blend;
  }

 private:
  Rectangle around(int reach) const {
    return {tile_.x0 - reach, tile_.y0 - reach, tile_.x1 + reach, tile_.y1 + reach};
  }
  float* total(int y) { return sums_.at(means_ + squares_, tile_.x0, y); }

  // Of the pieces of row y and those dx, dy beside them.
  void weigh(int dx, int dy, int y) {
    std::fill(numerator_.begin(), numerator_.end(), 0.0f);
    std::fill(denominator_.begin(), denominator_.end(), 1.0f);
    const std::ptrdiff_t shift = dy * features_.stride() + dx;
    for (std::size_t c = 0; c < channels_; ++c) {
      raise_distance(features_.at(2 * c, tile_.x0, y), features_.at(2 * c + 1, tile_.x0, y), shift,
                     options_.tau, width_, numerator_.data(), denominator_.data());
    }
    const auto spatial =
        static_cast<float>((dx * dx + dy * dy) / (2.0 * options_.sigma * options_.sigma));
    weights_of(numerator_.data(), denominator_.data(), spatial, static_cast<float>(std::exp(-kCut)),
               width_, weight_.data());
    for (int x = tile_.x0; x < std::min(tile_.x1, image_.x0 - dx); ++x)
      weight_[static_cast<std::size_t>(x - tile_.x0)] = 0.0f;
    for (int x = std::max(tile_.x0, image_.x1 - dx); x < tile_.x1; ++x)
      weight_[static_cast<std::size_t>(x - tile_.x0)] = 0.0f;
  }

  void add_offset(int dx, int dy) {
    for (int y = std::max(tile_.y0, image_.y0 - dy); y < std::min(tile_.y1, image_.y1 - dy); ++y) {
      weigh(dx, dy, y);
      add_row(weight_.data(), width_, total(y));
      for (std::size_t i = 0; i < means_ + squares_; ++i) {
        if (i == means_) square(weight_.data(), width_);
        add_products(weight_.data(), inputs_.at(i, tile_.x0 + dx, y + dy), width_,
                     sums_.at(i, tile_.x0, y));
      }
    }
  }

  Rectangle tile_, image_;
  const BlendOptions& options_;
  std::size_t means_, squares_, channels_;
  int width_;
  TilePlanes features_;  // value and variance of each channel in turn
  TilePlanes inputs_, sums_;
  std::vector<float> numerator_, denominator_, weight_;  // of the row at hand
};

}  // namespace

Blend feature_blend(const Rectangle& tile, std::span<const Image<float>* const> values,
                    std::span<const Image<float>* const> variances, const FeatureImages& features,
                    const BlendOptions& options) {
  return TileBlend(tile, values, variances, features, options).run();
}

}  // namespace spool
