#include "lib/filters/directional/filter_width.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/directional/structure_tensor.h"
#include "lib/pyramid/convolution.h"

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

// Details whose bands make the energies of size 2^level.
std::vector<int> source_details(int level, int levels, const FilterWidthOptions& options) {
  switch (options.bank_source) {
    case BankSource::kMatched:
      return {level - 1};
    case BankSource::kFixed:
      return {std::min(options.bank_detail, levels - 1)};
    case BankSource::kSum:
      break;
  }
  std::vector<int> all(static_cast<std::size_t>(level));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

template <class T>
DirectionalEnergy<T> bank_energy(const Pyramid& pyramid, const Plane& variance, int level,
                                 const DirectionalOptions& options, GuardCounts& guards) {
  std::vector<NoisyBands<T>> sources;
  for (const int detail : source_details(level, options.pyramid.levels, options.width)) {
    BankOptions bank = options.bank;
    bank.dilation = detail_dilation(detail);
    sources.push_back(
        {directional_bands(converted<T>(pyramid.detail[static_cast<std::size_t>(detail)]), bank),
         band_noise_gains(options.pyramid, bank, detail + 1, base_taps(options.base))});
  }
  return directional_energy<T>(std::move(sources), variance, level, options.energy, guards);
}

// q^gamma; the usual exponents without the price of pow.
double power(double q, double gamma) {
  if (gamma == 1.0) return q;
  if (gamma == 1.5) return q * std::sqrt(q);
  if (gamma == 2.0) return q * q;
  return std::pow(q, gamma);
}

bool is_round(const DirectionalOptions& options) {
  return options.width.anisotropy == AnisotropySource::kIsotropic || options.bank.levels == 0 ||
         (options.width.anisotropy == AnisotropySource::kFilterBank &&
          options.bank.kind == BankKind::kNone);
}

}  // namespace

Taps base_taps(BaseImage base) {
  if (base == BaseImage::kNone) return {0, {1.0}};
  const double side = std::exp(-2.0) - std::exp(-8.0), middle = 1.0 - std::exp(-8.0);
  const double sum = middle + 2.0 * side;
  return {-1, {side / sum, middle / sum, side / sum}};
}

template <class T>
FilterWidths<T> filter_widths(const Pyramid& pyramid, const Plane& variance,
                              const CountImage& level, const DirectionalOptions& options,
                              Views* views, GuardCounts& guards) {
  const int width = level.width(), height = level.height();
  const bool round = is_round(options);
  const std::vector<double> angles = round ? std::vector<double>{0.0}
                                           : (options.width.angle == FilterAngle::kTangent
                                                  ? band_tangents(options.bank.levels)
                                                  : band_frequency_angles(options.bank.levels));
  std::vector<std::size_t> order(angles.size());  // bands by ascending spatial direction
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return angles[a] < angles[b]; });

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
    if (!round) {
      energy = options.width.anisotropy == AnisotropySource::kStructureTensor
                   ? structure_tensor_energy<T>(pyramid, variance, k,
                                                band_tangents(options.bank.levels), options, guards)
                   : bank_energy<T>(pyramid, variance, k, options, guards);
      for (std::size_t i = 0; wanted && i < order.size(); ++i) {
        views->add(fmt::format("band_energy.{}.{}", k, i),
                   converted<double>(energy.energy[order[i]]));
      }
    }
    const double widest = options.width.sigma_max * std::ldexp(1.0, k);
    const double rho = options.width.rho;
    std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
    parallel_rows(0, height, [&](int y) {
      std::uint64_t floors = 0, overflows = 0;
      for (int x = 0; x < width; ++x) {
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
          double delta = widest * (rho + (1.0 - rho) * power(q, options.width.gamma_d));
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
  for (std::size_t i = 0; views && views->wants("delta") && i < order.size(); ++i)
    views->add(fmt::format("delta.{}", i), converted<double>(result.delta[i]));
  return result;
}

template FilterWidths<double> filter_widths(const Pyramid&, const Plane&, const CountImage&,
                                            const DirectionalOptions&, Views*, GuardCounts&);
template FilterWidths<float> filter_widths(const Pyramid&, const Plane&, const CountImage&,
                                           const DirectionalOptions&, Views*, GuardCounts&);

}  // namespace spool
