#include "lib/filters/directional/filter_width.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/directions/band_angles.h"
#include "lib/directions/band_noise_gains.h"
#include "lib/filters/directional/base_image.h"
#include "lib/filters/directional/structure_tensor.h"

namespace spool {
namespace {

constexpr double kLeastWidth = 0.25;  // pieces; keeps eq 11 defined

template <class T, class From>
Image<T> converted(const Image<From>& plane) {
  Image<T> result(plane.width(), plane.height());
  parallel_rows(0, plane.height(), [&](int y) {
    for (int x = 0; x < plane.width(); ++x)
      result(x, y) = static_cast<T>(plane(x, y));
  });
  return result;
}

// E_i of d_{level-1}
template <class T>
DirectionalEnergy<T> bank_energy(const Pyramid& pyramid, const Plane& variance, int level,
                                 const DirectionalOptions& options, GuardCounts& guards) {
  BankOptions bank = options.bank;
  bank.dilation = detail_dilation(level - 1);
  const Plane& detail = pyramid.detail[static_cast<std::size_t>(level - 1)];
  NoisyBands<T> noisy = {directional_bands(converted<T>(detail), bank),
                         band_noise_gains(options.pyramid, bank, level, base_taps(options.base))};
  return directional_energy<T>(std::move(noisy), variance, level, options.energy, guards);
}

// q^gamma; the usual exponents without the price of pow.
double power(double q, double gamma) {
  if (gamma == 1.0) return q;
  if (gamma == 1.5) return q * std::sqrt(q);
  if (gamma == 2.0) return q * q;
  return std::pow(q, gamma);
}

bool is_round(const DirectionalOptions& options) {
  return options.width.anisotropy == AnisotropySource::kNone || options.bank.levels == 0;
}

// Spatial angles of the bands; a round filter has one direction, which is any.
std::vector<double> spatial_angles(const DirectionalOptions& options) {
  if (is_round(options)) return {0.0};
  return options.width.angle == FilterAngle::kTangent ? band_tangents(options.bank.levels)
                                                      : band_frequency_angles(options.bank.levels);
}

// Bands by ascending spatial direction.
std::vector<std::size_t> by_angle(const std::vector<double>& angles) {
  std::vector<std::size_t> order(angles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return angles[a] < angles[b]; });
  return order;
}

// delta_i of the pieces of level k; without energies the filter is round.
template <class T>
void set_widths(const DirectionalEnergy<T>& energy, const std::vector<std::size_t>& order,
                const CountImage& level, int k, const FilterWidthOptions& options,
                FilterWidths<T>& result, GuardCounts& guards) {
  const bool round = energy.energy.empty();
  const double widest = options.sigma_max * std::ldexp(1.0, k), rho = options.rho;
  std::vector<GuardCounts> caught(static_cast<std::size_t>(level.height()));
  parallel_rows(0, level.height(), [&](int y) {
    std::uint64_t floors = 0, overflows = 0;
    for (int x = 0; x < level.width(); ++x) {
      if (level(x, y) != k) continue;
      bool no_direction = round || energy.isotropic(x, y) != 0;
      double largest = 0.0;
      std::size_t best = 0;
      for (std::size_t i = 0; !no_direction && i < order.size(); ++i) {
        const double e = static_cast<double>(energy.energy[order[i]](x, y));
        if (e > largest || std::isnan(e)) largest = e, best = i;
      }
      if (!std::isfinite(largest)) {  // squares of a firefly beyond the range of T
        no_direction = true;
        ++overflows;
      }
      for (std::size_t i = 0; i < order.size(); ++i) {
        const double q =
            no_direction ? 1.0 : static_cast<double>(energy.energy[order[i]](x, y)) / largest;
        double delta = widest * (rho + (1.0 - rho) * power(q, options.gamma_d));
        if (delta < kLeastWidth) delta = kLeastWidth, ++floors;
        result.delta[i](x, y) = static_cast<T>(delta);
      }
      if (!no_direction) result.dominant(x, y) = result.beta[best];
    }
    caught[static_cast<std::size_t>(y)].add(Guard::kFilterFloor, floors);
    caught[static_cast<std::size_t>(y)].add(Guard::kIsotropicFallback, overflows);
  });
  for (const GuardCounts& row : caught)
    guards += row;
}

}  // namespace

template <class T>
FilterWidths<T> filter_widths(const Pyramid& pyramid, const Plane& variance,
                              const CountImage& level, const DirectionalOptions& options,
                              Views* views, GuardCounts& guards) {
  const int width = level.width(), height = level.height();
  const std::vector<double> angles = spatial_angles(options);
  const std::vector<std::size_t> order = by_angle(angles);
  FilterWidths<T> result;
  for (const std::size_t i : order)
    result.beta.push_back(angles[i]);
  result.delta.assign(angles.size(), Image<T>(width, height));
  result.dominant = Plane(width, height, std::numeric_limits<double>::quiet_NaN());

  for (int k = 1; k <= options.pyramid.levels; ++k) {
    const bool wanted = views && views->wants("band_energy");
    const bool present =
        std::find(level.pixels().begin(), level.pixels().end(), k) != level.pixels().end();
    if (!present && !wanted) continue;
    DirectionalEnergy<T> energy;
    if (!is_round(options)) {
      energy = options.width.anisotropy == AnisotropySource::kStructureTensor
                   ? structure_tensor_energy<T>(pyramid, variance, k,
                                                band_tangents(options.bank.levels), options, guards)
                   : bank_energy<T>(pyramid, variance, k, options, guards);
      for (std::size_t i = 0; wanted && i < order.size(); ++i) {
        views->add(fmt::format("band_energy.{}.{}", k, i),
                   converted<double>(energy.energy[order[i]]));
      }
    }
    set_widths(energy, order, level, k, options.width, result, guards);
  }
  for (std::size_t i = 0; views && views->wants("delta") && i < order.size(); ++i)
    views->add(fmt::format("delta.{}", i), converted<double>(result.delta[i]));
  return result;
}

template FilterWidths<double> filter_widths(const Pyramid&, const Plane&, const CountImage&,
                                            const DirectionalOptions&, Views*, GuardCounts&);
template FilterWidths<float> filter_widths(const Pyramid&, const Plane&, const CountImage&,
                                           const DirectionalOptions&, Views*, GuardCounts&);

}  // namespace spool
