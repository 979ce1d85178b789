#include "lib/filters/twin_guides/robust_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/filters/twin_guides/tile_planes.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kPerSample = 1.25;  // the limit opens with n, so that the estimate converges
constexpr float kMeans = 2.0f;       // of the mean around: the least geometric mean of a window

}  // namespace

void raise_logarithms(SampleMoments& moments, double sigma, const RadianceScale& scale) {
  Image<float> around(moments.log_luminance.width(), moments.log_luminance.height());
  parallel_rows(0, around.height(), [&](int y) {
    for (std::size_t i = around.index(0, y); i < around.index(0, y + 1); ++i)
      around[i] =
          static_cast<float>(luminance(moments.mean[0][i], moments.mean[1][i], moments.mean[2][i]));
  });
  around = convolve(around, four_sigma_taps(sigma));
  const auto floor = static_cast<float>(kLogFloor * scale.mean);
  parallel_rows(0, around.height(), [&](int y) {
    for (std::size_t i = around.index(0, y); i < around.index(0, y + 1); ++i) {
      const float least = std::log(std::max(around[i], 0.0f) * kMeans + floor);
      moments.log_luminance[i] = std::max(moments.log_luminance[i], least);
    }
  });
}

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
    weights.sum(logs, 0, tile.x0, y, width, sum.data(), total.data());
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
