#include "lib/kernels/guide_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr float kLeastVariance = FeatureGuide::kLeastVariance;
constexpr std::size_t kMostFeatures = FeatureGuide::kMostFeatures;
constexpr std::size_t kMostChannels = 3 * kMostFeatures;
constexpr int kLanes = GuideTile::kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));

// Features of two rows of pieces, channels one after the other.
struct RowPair {
  std::array<const float*, kMostChannels> p, q;
  std::array<const float*, kMostFeatures> vp, vq;
  std::array<int, kMostFeatures + 1> channels{};  // of feature f: from [f] to [f + 1]
  std::size_t features = 0;
};

// to[dx * stride] = weights of kLanes pieces from x on with those at dx0 .. dx1 from them: exp(-sum
// of the features' terms), which are brought to one denominator, as a division costs as much as the
// rest.
SPOOL_VECTOR_CLONES
void weights_of_lanes(const RowPair& rows, int x, int dx0, int dx1, std::ptrdiff_t stride,
                      float* to) {
  Floats p[kMostChannels], variance_of_p[kMostFeatures];
  const auto channels = static_cast<std::size_t>(rows.channels[rows.features]);
  for (std::size_t c = 0; c < std::min(kMostChannels, channels); ++c)
    std::memcpy(&p[c], rows.p[c] + x, sizeof(Floats));
  for (std::size_t f = 0; f < std::min(kMostFeatures, rows.features); ++f)
    std::memcpy(&variance_of_p[f], rows.vp[f] + x, sizeof(Floats));
  for (int dx = dx0; dx <= dx1; ++dx) {
    Floats distances{}, divisor = Floats{} + 1.0f, q;
    for (std::size_t f = 0; f < rows.features; ++f) {
      Floats squares{};
      for (int c = rows.channels[f]; c < rows.channels[f + 1]; ++c) {
        std::memcpy(&q, rows.q[static_cast<std::size_t>(c)] + x + dx, sizeof(Floats));
        const Floats difference = p[c] - q;
        squares += difference * difference;
      }
      std::memcpy(&q, rows.vq[f] + x + dx, sizeof(Floats));
      const Floats sum = variance_of_p[f] + q;
      const Floats variance = sum > kLeastVariance ? sum : Floats{} + kLeastVariance;
      distances = distances * variance + squares * divisor;
      divisor *= variance;
    }
    distances /= divisor;
    float weights[kLanes];
    std::memcpy(weights, &distances, sizeof(weights));
    for (float& weight : weights)
      weight = exp_negative(weight);
    std::memcpy(to + dx * stride, weights, sizeof(weights));
  }
}

// `factor` times the part of an image from (x0, y0) on, 0 beyond it.
Image<float> part_of(const Image<float>& image, float factor, int x0, int y0, int width,
                     int height) {
  Image<float> part(width, height);
  for (int y = std::max(0, y0); y < std::min(image.height(), y0 + height); ++y) {
    for (int x = std::max(0, x0); x < std::min(image.width(), x0 + width); ++x)
      part(x - x0, y - y0) = factor * image(x, y);
  }
  return part;
}

}  // namespace

GuideTile::GuideTile(const FeatureGuide& guide, const Rectangle& tile, int across, int down)
    : guide_width_(guide.width), tile_(tile), across_(across), down_(down) {
  const int width = tile.width() + 4 * across + kLanes, height = tile.height() + 2 * down;
  const auto part = [&](const Image<float>& image, float factor) {
    return part_of(image, factor, tile.x0 - 2 * across, tile.y0 - down, width, height);
  };
  for (const FeatureGuide::Feature& feature : guide.features) {
    Feature& here = features_.emplace_back();
    for (const Image<float>& mean : feature.mean)
      here.mean.push_back(part(mean, std::sqrt(feature.factor)));
    here.variance = part(feature.variance, 1.0f);
  }
}

void GuideTile::weights(int y, int qy, bool beside, std::ptrdiff_t stride, float* to) const {
  RowPair rows;
  const int row = y - tile_.y0 + down_, q_row = qy - tile_.y0 + down_;
  std::size_t channel = 0;
  for (const Feature& feature : features_) {
    for (const Image<float>& mean : feature.mean) {  // piece i is column i + across
      rows.p[channel] = &mean(across_, row);
      rows.q[channel++] = &mean(across_, q_row);
    }
    rows.vp[rows.features] = &feature.variance(across_, row);
    rows.vq[rows.features] = &feature.variance(across_, q_row);
    rows.channels[++rows.features] = static_cast<int>(channel);
  }
  const int first = beside ? 0 : across_, end = tile_.width() + (beside ? 2 : 1) * across_;
  for (int i = first; i < end; i += kLanes) {
    const int before = across_ - (i + kLanes - 1), behind = i - (across_ + tile_.width()) + 1;
    weights_of_lanes(rows, i, before > 0 ? before : -across_, behind > 0 ? -behind : across_,
                     stride, to + i + across_ * stride);
  }
  for (int dx = -across_; dx <= across_; ++dx) {
    float* offset = to + (dx + across_) * stride;
    const int from = tile_.x0 - across_;  // the x of piece 0
    const int inside0 = std::clamp(std::max(0, -dx) - from, first, end);
    const int inside1 = std::clamp(guide_width_ - std::max(0, dx) - from, inside0, end);
    std::fill(offset + first, offset + inside0, 0.0f);
    std::fill(offset + inside1, offset + end, 0.0f);
  }
}

}  // namespace spool
