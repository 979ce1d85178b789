#include "lib/filters/twin_guides/robust_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kPerSample = 1.25;  // the limit opens with n, so that the estimate converges
constexpr double kMeans = 3.0;       // of the mean that is certain
constexpr double kErrors = 2.0;      // of the mean, which are taken off

enum Plane : std::size_t { kLogarithm, kLuminance, kGreen, kBlue, kPlanes };

// Logarithms and luminances of the tile and its windows.
TilePlanes planes_of(const Lattice& lattice, const Rectangle& around, const ScaleInputs& inputs) {
  TilePlanes planes(around, kPlanes);
  planes.copy_clamped(kLogarithm, inputs.log_luminance, lattice);
  for (std::size_t c = 0; c < 3; ++c)
    planes.copy_clamped(kLuminance + c, inputs.colour[c], lattice);
  for (int y = around.y0; y < around.y1; ++y) {
    float* to = planes.at(kLuminance, around.x0, y);
    const float* green = planes.at(kGreen, around.x0, y);
    const float* blue = planes.at(kBlue, around.x0, y);
    for (int x = 0; x < around.width(); ++x)
      to[x] = static_cast<float>(luminance(to[x], green[x], blue[x]));
  }
  return planes;
}

}  // namespace

Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const ScaleInputs& inputs,
                           const CountImage& n, double limit) {
  const int r = weights.radius();
  const TilePlanes planes =
      planes_of(lattice, {tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r}, inputs);
  Image<float> top(tile.width(), tile.height());
  const int width = whole_vectors(tile.width());
  std::vector<float> logarithm(static_cast<std::size_t>(width)), mean(logarithm),
      squares(logarithm), total(logarithm);
  for (int y = tile.y0; y < tile.y1; ++y) {
    weights.sum(planes, kLogarithm, tile.x0, y, width, logarithm.data(), total.data());
    weights.sum(planes, kLuminance, tile.x0, y, width, mean.data(), total.data());
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean[i] /= total[i];
    weights.squared_deviations(planes, kLuminance, tile.x0, y, width, mean.data(), squares.data());
    for (int x = 0; x < tile.width(); ++x) {
      const auto i = static_cast<std::size_t>(x);
      const double certain = mean[i] - kErrors * std::sqrt(squares[i]) / total[i];
      const double middle =
          std::max(std::exp(static_cast<double>(logarithm[i] / total[i])), kMeans * certain);
      const double factor =
          std::max(limit, kPerSample * n(lattice.column(tile.x0 + x), lattice.row(y)));
      top(x, y - tile.y0) = static_cast<float>(factor * middle);
    }
  }
  return top;
}

}  // namespace spool
