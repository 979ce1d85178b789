#include "lib/kernels/kernel_footprint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace spool {
namespace {

// Of one piece, times `share`.
void add_guided_piece(const FeatureGuide& guide, const RgbImage& values, double scale, int x, int y,
                      double share, int q, Footprint& to) {
  if (scale == 0.0) {
    to.add(x / q, y / q, share, values, values[0].index(x, y));
    return;
  }
  const int radius = static_cast<int>(std::lround(2.0 * scale));
  std::vector<std::pair<std::size_t, double>> weights;
  double total = 0.0;
  for (int qy = std::max(0, y - radius); qy <= std::min(guide.height - 1, y + radius); ++qy) {
    for (int qx = std::max(0, x - radius); qx <= std::min(guide.width - 1, x + radius); ++qx) {
      float weight = 0.0f;
      feature_weights(guide, y, qy, qx - x, x, x + 1, &weight);
      const double squared = (qx - x) * (qx - x) + (qy - y) * (qy - y);
      weights.emplace_back(values[0].index(qx, qy),
                           weight * std::exp(-squared / (2.0 * scale * scale)));
      total += weights.back().second;
    }
  }
  const auto width = static_cast<std::size_t>(guide.width);
  for (const auto& [at, weight] : weights) {
    to.add(static_cast<int>(at % width) / q, static_cast<int>(at / width) / q,
           share * weight / total, values, at);
  }
}

}  // namespace

Footprint guided_footprint(const FeatureGuide& guide, const RgbImage& values,
                           const CountImage& scale, std::span<const double> scales,
                           int pieces_per_side, int x, int y) {
  const int q = pieces_per_side;
  Footprint footprint{x, y, {}, {}};
  for (int i = 0; i < q * q; ++i) {
    const int px = x * q + i % q, py = y * q + i / q;
    add_guided_piece(guide, values, scales[static_cast<std::size_t>(scale(px, py))], px, py,
                     1.0 / (q * q), q, footprint);
  }
  return footprint;
}

std::vector<PatchWeight> patch_weights(const HalfImage& guide, const PatchFilterOptions& options,
                                       int x, int y) {
  constexpr std::size_t kAtOnce = 4;  // targets of one run
  const int width = guide.mean[0].width(), height = guide.mean[0].height();
  std::vector<PatchWeight> weights;
  for (int qy = std::max(0, y - options.window); qy <= std::min(height - 1, y + options.window);
       ++qy) {
    for (int qx = std::max(0, x - options.window); qx <= std::min(width - 1, x + options.window);
         ++qx)
      weights.push_back({qx, qy});
  }
  std::array<Plane, kAtOnce> marked;
  marked.fill(Plane(width, height));
  for (std::size_t first = 0; first < weights.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, weights.size() - first);
    GuidedTargets targets{{}, &guide};
    for (std::size_t i = 0; i < count; ++i) {
      marked[i](weights[first + i].x, weights[first + i].y) = 1.0;
      targets.targets.push_back(&marked[i]);
    }
    const std::vector<Plane> filtered = filter_tile(targets, options, {x, y, x + 1, y + 1});
    for (std::size_t i = 0; i < count; ++i) {
      weights[first + i].weight = filtered[i](0, 0);
      marked[i](weights[first + i].x, weights[first + i].y) = 0.0;
    }
  }
  return weights;
}

}  // namespace spool
