#include "lib/filters/twin_guides/robust_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {
namespace {

constexpr double kPerSample = 1.25;  // the limit opens with n, so that the estimate converges
constexpr double kMeans = 3.0;       // of the lower bound of the mean
constexpr double kErrors = 2.0;      // standard errors from the mean to its lower bound
constexpr double kErrorsOfHeavy = 0.5;

enum Values : std::size_t { kLogarithm, kLuminance, kPlanes };

TilePlanes planes_of(const Lattice& lattice, const Rectangle& around, const FitTable& table,
                     const Image<float>& log_luminance) {
  TilePlanes planes(around, kPlanes);
  planes.clear();
  planes.copy_clamped(kLogarithm, log_luminance, lattice);
  const Rectangle inside = intersect(around, lattice.bounds());
  for (int y = inside.y0; y < inside.y1; ++y)
    std::copy_n(table.luminances() + table.place(inside.x0, y), inside.width(),
                planes.at(kLuminance, inside.x0, y));
  return planes;
}

}  // namespace

Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const FitTable& table,
                           const Image<float>& log_luminance, const CountImage& n,
                           const Plane& heavy, double limit) {
  const int r = weights.radius();
  const TilePlanes planes = planes_of(lattice, {tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r},
                                      table, log_luminance);
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
      const int column = lattice.column(tile.x0 + x), row = lattice.row(y);
      const double h = heavy.empty() ? 0.0 : heavy(column, row);
      const double errors = kErrors + h * (kErrorsOfHeavy - kErrors);
      const double bound = mean[i] - errors * std::sqrt(squares[i]) / total[i];
      const double middle =
          std::max(std::exp(static_cast<double>(logarithm[i] / total[i])), kMeans * bound);
      const double factor = std::max(limit, kPerSample * n(column, row));
      top(x, y - tile.y0) = static_cast<float>(factor * middle);
    }
  }
  return top;
}

}  // namespace spool
