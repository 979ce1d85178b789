// Inputs for the tests of the directional reconstruction's stages.
#pragma once

#include <cmath>
#include <vector>

#include "lib/core/random.h"
#include "lib/directions/band_angles.h"
#include "lib/filters/directional/anisotropic_filter.h"
#include "lib/filters/directional/filter_size.h"

namespace spool::testing {

inline double random_unit(std::uint64_t seed, std::uint64_t stream, std::size_t i) {
  return unit_double(mix(seed, stream, i));
}

// Owns what a FilterSizeInput refers to.
struct SizeCase {
  Plane mean, variance, minimum, maximum;
  CountImage n;
  std::vector<Plane> coarse, attenuation;
  int levels = 4;

  FilterSizeInput input() const {
    return {mean, variance, n, minimum, maximum, coarse, attenuation, levels};
  }
};

// A step with noise, uneven counts and variances, attenuation with zeros and ones.
inline SizeCase random_size_case(int width, int height, std::uint64_t seed) {
  SizeCase c{Plane(width, height),
             Plane(width, height),
             Plane(width, height),
             Plane(width, height),
             CountImage(width, height),
             {},
             {},
             4};
  for (std::size_t i = 0; i < c.mean.size(); ++i) {
    const int x = static_cast<int>(i % static_cast<std::size_t>(width));
    c.n[i] = 1 + static_cast<int>(5 * random_unit(seed, 1, i));
    c.variance[i] = 0.04 * random_unit(seed, 2, i) / c.n[i];
    c.mean[i] = (x > width / 2 ? 1.0 : 0.4) + 0.3 * (random_unit(seed, 3, i) - 0.5);
    c.minimum[i] = c.mean[i] - 0.3 * random_unit(seed, 4, i);
    c.maximum[i] = c.mean[i] + 0.3 * random_unit(seed, 5, i);
  }
  for (int k = 0; k <= c.levels; ++k) {
    Plane f(width, height), a(width, height);
    for (std::size_t i = 0; i < f.size(); ++i) {
      f[i] = c.mean[i] + 0.1 * random_unit(seed, 10 + k, i);
      const double u = random_unit(seed, 20 + k, i);
      a[i] = u < 0.1 ? 0.0 : (u < 0.3 ? 1.0 : u * u);
    }
    c.coarse.push_back(f);
    c.attenuation.push_back(a);
  }
  return c;
}

// filter_in_place() of a copy.
template <class T>
FilteredPieces filter_pieces(const FilterInput& input, const FilterWidths<T>& widths,
                             const FilterOptions& options, GuardCounts& guards) {
  FilteredPieces pieces{input.mean, input.variance};
  filter_in_place(input.n, input.level, widths, options, pieces, guards);
  return pieces;
}

// Owns what a FilterInput refers to.
struct FilterCase {
  CountImage n, level;
  RgbImage mean, variance;

  FilterInput input() const { return {n, level, mean, variance}; }
};

inline FilterCase random_filter_case(int width, int height, std::uint64_t seed, int levels = 4) {
  FilterCase c{CountImage(width, height), CountImage(width, height), make_rgb(width, height),
               make_rgb(width, height)};
  for (std::size_t i = 0; i < c.n.size(); ++i) {
    c.n[i] = static_cast<int>(6 * random_unit(seed, 1, i));
    c.level[i] = static_cast<int>((levels + 1) * random_unit(seed, 2, i / 3));
    for (std::size_t channel = 0; channel < 3; ++channel) {
      c.mean[channel][i] = random_unit(seed, 3 + channel, i);
      c.variance[channel][i] = 0.1 * random_unit(seed, 6 + channel, i);
    }
  }
  return c;
}

template <class T>
FilterWidths<T> random_widths(const CountImage& level, int bank_levels, std::uint64_t seed) {
  FilterWidths<T> widths;
  widths.beta = band_tangents(bank_levels);
  std::sort(widths.beta.begin(), widths.beta.end());
  for (std::size_t b = 0; b < widths.beta.size(); ++b) {
    Image<T> delta(level.width(), level.height());
    for (std::size_t i = 0; i < level.size(); ++i) {
      delta[i] = static_cast<T>(0.25 + 0.4 * std::ldexp(random_unit(seed, 30 + b, i), level[i]));
    }
    widths.delta.push_back(delta);
  }
  return widths;
}

template <class T>
FilterWidths<T> constant_widths(const CountImage& level, std::vector<double> beta,
                                const std::vector<double>& delta) {
  FilterWidths<T> widths;
  widths.beta = std::move(beta);
  for (const double d : delta)
    widths.delta.emplace_back(level.width(), level.height(), static_cast<T>(d));
  return widths;
}

}  // namespace spool::testing
