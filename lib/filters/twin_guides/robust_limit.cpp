#include "lib/filters/twin_guides/robust_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kPerSample = 1.25;  // the limit opens with n, so that the estimate converges

SPOOL_VECTOR_CLONES
void add_weighted(const float* weight, const float* value, int width, float* __restrict sum,
                  float* __restrict total) {
  for (int x = 0; x < width; ++x) {
    sum[x] += weight[x] * value[x];
    total[x] += weight[x];
  }
}

}  // namespace

Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const Image<float>& log_luminance,
                           const CountImage& n, double limit) {
  const int r = weights.radius();
  TilePlanes logs({tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r}, 1);
  logs.copy_clamped(0, log_luminance, lattice);
  Image<float> top(tile.width(), tile.height());
  const int width = whole_vectors(tile.width());
  std::vector<float> sum(static_cast<std::size_t>(width)), total(sum);
  for (int y = tile.y0; y < tile.y1; ++y) {
    std::fill(sum.begin(), sum.end(), 0.0f);
    std::fill(total.begin(), total.end(), 0.0f);
    for (std::size_t o = 0; o < weights.offsets().size(); ++o) {
      const auto [dx, dy] = weights.offsets()[o];
      add_weighted(weights.row(o, tile.x0, y), logs.at(0, tile.x0 + dx, y + dy), width, sum.data(),
                   total.data());
    }
    for (int x = 0; x < tile.width(); ++x) {
      const auto i = static_cast<std::size_t>(x);
      const double factor =
          std::max(limit, kPerSample * n(lattice.column(tile.x0 + x), lattice.row(y)));
      top(x, y - tile.y0) =
          static_cast<float>(factor * std::exp(static_cast<double>(sum[i] / total[i])));
    }
  }
  return top;
}

}  // namespace spool
