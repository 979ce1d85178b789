#include "lib/filters/directional/structure_tensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/filters/directional/base_image.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

struct Gradient {
  Plane x, y;
};

Gradient gradient(const Plane& f) {
  const int width = f.width(), height = f.height();
  Gradient g{Plane(width, height), Plane(width, height)};
  parallel_rows(0, height, [&](int y) {
    const int up = extend_symmetric(y - 1, height), down = extend_symmetric(y + 1, height);
    for (int x = 0; x < width; ++x) {
      const int left = extend_symmetric(x - 1, width), right = extend_symmetric(x + 1, width);
      g.x(x, y) = 0.5 * (f(right, y) - f(left, y));
      g.y(x, y) = 0.5 * (f(x, down) - f(x, up));
    }
  });
  return g;
}

// Sum of squares of the response of a difference of f_{level-1} to a delta. The filters are
// separable and have sum 1, so one row gives the response a along an axis, and (sum of (Da)^2) (sum
// of a^2) that of the image.
double gradient_gain(const DirectionalOptions& options, int level) {
  const int n = 64 << level;  // wider than any response: taps reach 4 (2^k - 1) + 2
  Plane delta(n, 1);
  delta(n / 2, 0) = 1.0;
  PyramidOptions pyramid = options.pyramid;
  pyramid.levels = level;
  const Plane a = build_pyramid(convolve(delta, base_taps(options.base)), pyramid)
                      .coarse[static_cast<std::size_t>(level - 1)];
  const Plane difference = gradient(a).x;
  double differences = 0.0, values = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differences += difference[i] * difference[i];
    values += a[i] * a[i];
  }
  return differences * values;
}

// Unit vector across the structure of an angle in degrees.
struct Normal {
  double x, y;
};
std::vector<Normal> normals_of(std::span<const double> angles) {
  std::vector<Normal> normals;
  for (const double angle : angles) {
    const double radians = (angle + 90.0) * std::numbers::pi / 180.0;
    normals.push_back({std::cos(radians), std::sin(radians)});
  }
  return normals;
}

}  // namespace

template <class T>
DirectionalEnergy<T> structure_tensor_energy(const Pyramid& pyramid, const Plane& variance,
                                             int level, std::span<const double> angles,
                                             const DirectionalOptions& options,
                                             GuardCounts& guards) {
  const int width = variance.width(), height = variance.height();
  const Gradient g = gradient(pyramid.coarse[static_cast<std::size_t>(level - 1)]);
  const double sigma = options.energy.smoothing * std::ldexp(1.0, level);
  Plane xx(width, height), xy(width, height), yy(width, height);
  for (std::size_t i = 0; i < xx.size(); ++i) {
    xx[i] = g.x[i] * g.x[i];
    xy[i] = g.x[i] * g.y[i];
    yy[i] = g.y[i] * g.y[i];
  }
  xx = gaussian_blur(xx, sigma, options.energy.extension);
  xy = gaussian_blur(xy, sigma, options.energy.extension);
  yy = gaussian_blur(yy, sigma, options.energy.extension);
  const Plane noise = gaussian_blur(variance, sigma, options.energy.extension);
  const double gain = gradient_gain(options, level);
  const std::vector<Normal> normals = normals_of(angles);

  DirectionalEnergy<T> result;
  result.energy.assign(angles.size(), Image<T>(width, height));
  result.isotropic = Image<std::uint8_t>(width, height);
  std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
  parallel_rows(0, height, [&](int y) {
    GuardCounts& row = caught[static_cast<std::size_t>(y)];
    for (int x = 0; x < width; ++x) {
      double largest = 0.0;
      const double in_noise = gain * noise(x, y);
      const double shown_in_noise = options.energy.stand_out * in_noise;
      for (std::size_t i = 0; i < angles.size(); ++i) {
        const auto [nx, ny] = normals[i];
        double e = nx * nx * xx(x, y) + 2.0 * nx * ny * xy(x, y) + ny * ny * yy(x, y);
        if (options.energy.noise_correct) e -= in_noise;
        if (e < 0.0) {
          row.add(Guard::kNegativeBandEnergy);
          e = 0.0;
        }
        largest = std::max(largest, e);
        e += shown_in_noise;
        result.energy[i](x, y) = static_cast<T>(e);
      }
      if (largest <= 1e-3 * in_noise || largest <= 1e-20) {
        row.add(Guard::kIsotropicFallback);
        result.isotropic(x, y) = 1;
      }
    }
  });
  for (const GuardCounts& row : caught)
    guards += row;
  return result;
}

template DirectionalEnergy<double> structure_tensor_energy(const Pyramid&, const Plane&, int,
                                                           std::span<const double>,
                                                           const DirectionalOptions&, GuardCounts&);
template DirectionalEnergy<float> structure_tensor_energy(const Pyramid&, const Plane&, int,
                                                          std::span<const double>,
                                                          const DirectionalOptions&, GuardCounts&);

}  // namespace spool
