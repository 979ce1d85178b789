// Slow twin of decide=halves in lib/filters/directional/directional.h: round filters, no base
// image, no pooled noise, from single samples on; every piece has four samples or more.
#pragma once

#include <array>
#include <vector>

#include "lib/pool/sample_pool.h"
#include "tests/reference/anisotropic_filter_reference.h"
#include "tests/reference/filter_size_reference.h"
#include "tests/reference/lone_sizes_reference.h"

namespace spool::reference {

// Mean and variance of the mean of samples parity, parity + 2, ... of n(x, y) each.
struct HalfOfSamples {
  CountImage n;
  RgbImage mean, variance;
  Plane luminance, luminance_variance;  // exposed to mean 1
};

inline HalfOfSamples half_of_samples(const SamplePool& pool, const CountImage& n, int parity) {
  const Plane blank(n.width(), n.height());
  HalfOfSamples half{CountImage(n.width(), n.height()),
                     {blank, blank, blank},
                     {blank, blank, blank},
                     blank,
                     blank};
  double all = 0.0;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      std::vector<std::array<double, 4>> values;  // red, green, blue, luminance
      for (int s = parity; s < n(x, y); s += 2) {
        const Rgb v = pool.sample(x, y, s);
        values.push_back({v[0], v[1], v[2], luminance(v[0], v[1], v[2])});
      }
      const auto count = static_cast<double>(values.size());
      half.n(x, y) = static_cast<int>(values.size());
      for (std::size_t c = 0; c < 4; ++c) {
        double mean = 0.0, squares = 0.0;
        for (const auto& v : values)
          mean += v[c] / count;
        for (const auto& v : values)
          squares += (v[c] - mean) * (v[c] - mean);
        (c < 3 ? half.mean[c] : half.luminance)(x, y) = mean;
        (c < 3 ? half.variance[c] : half.luminance_variance)(x, y) =
            squares / (count - 1.0) / count;
      }
      all += half.luminance(x, y);
    }
  }
  const double exposure = static_cast<double>(n.size()) / all;
  for (std::size_t i = 0; i < n.size(); ++i) {
    half.luminance[i] *= exposure;
    half.luminance_variance[i] *= exposure * exposure;
  }
  return half;
}

// Each half under the sizes of the other, and their mean.
inline FilteredPieces directional_halves(const SamplePool& pool, const CountImage& n,
                                         const DirectionalOptions& options) {
  const std::array<HalfOfSamples, 2> halves = {half_of_samples(pool, n, 0),
                                               half_of_samples(pool, n, 1)};
  const Plane blank(n.width(), n.height());
  FilteredPieces sum{{blank, blank, blank}, {blank, blank, blank}};
  for (std::size_t h = 0; h < 2; ++h) {
    const HalfOfSamples &averaged = halves[h], &deciding = halves[1 - h];
    const FilterSizeInput input{
        deciding.luminance,    deciding.luminance_variance, deciding.n, blank, blank, {}, {},
        options.pyramid.levels};
    CountImage level = reference::filter_size(input, options.size).level;
    if (!options.size.lone) level = without_lone_sizes(level, {}, deciding.luminance);
    FilterWidths<double> round;
    round.beta = {0.0};
    round.delta = {blank};
    for (std::size_t i = 0; i < level.size(); ++i)
      round.delta[0][i] = std::fmax(0.25, options.width.sigma_max * std::pow(2.0, level[i]));
    const FilteredPieces filtered = filter_pieces<double>(
        {averaged.n, level, averaged.mean, averaged.variance}, round, options.filter);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < level.size(); ++i) {
        sum.image[c][i] += 0.5 * filtered.image[c][i];
        sum.variance[c][i] += 0.25 * filtered.variance[c][i];
      }
    }
  }
  return sum;
}

}  // namespace spool::reference
