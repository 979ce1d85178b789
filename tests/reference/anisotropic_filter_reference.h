// Slow twins of lib/filters/directional/filter_width.h and anisotropic_filter.h: eqs 10-12
// as they stand, one neighbour after the other.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "lib/directions/band_angles.h"
#include "lib/directions/band_noise_gains.h"
#include "lib/filters/directional/anisotropic_filter.h"
#include "lib/filters/directional/base_image.h"
#include "tests/reference/directional_energy_reference.h"
#include "tests/reference/directional_filter_bank_reference.h"

namespace spool::reference {

// Width towards (dx, dy) from the widths along beta (ascending, degrees).
inline double width_along(double dx, double dy, const std::vector<double>& beta,
                          const std::vector<double>& delta, Eq12 form) {
  const std::size_t count = beta.size();
  if (count == 1) return delta[0];
  double b = std::atan2(dy, dx) * 180.0 / std::numbers::pi;
  while (b < beta[0])
    b += 180.0;
  while (b >= beta[0] + 180.0)
    b -= 180.0;
  std::size_t i = 0;
  while (i + 1 < count && beta[i + 1] <= b)
    ++i;
  const std::size_t j = (i + 1) % count;
  const double end = j == 0 ? beta[0] + 180.0 : beta[j];
  const double t = (b - beta[i]) / (end - beta[i]);
  return form == Eq12::kCorrected ? (1.0 - t) * delta[i] + t * delta[j]
                                  : t * delta[i] + (1.0 - t) * delta[j];
}

template <class T>
FilteredPieces filter_pieces(const FilterInput& input, const FilterWidths<T>& widths,
                             const FilterOptions& options) {
  const int width = input.level.width(), height = input.level.height();
  FilteredPieces out{input.mean, input.variance};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int k = input.level(x, y);
      if (k == 0) continue;
      std::vector<double> delta;
      for (const auto& plane : widths.delta)
        delta.push_back(static_cast<double>(plane(x, y)));
      const int radius = 1 << (k - 1);
      double total = 0.0, value[3] = {}, variance[3] = {};
      for (int py = 0; py < height; ++py) {
        for (int px = 0; px < width; ++px) {
          const int dx = px - x, dy = py - y;
          const bool inside = options.window == FilterWindow::kDisc
                                  ? dx * dx + dy * dy <= radius * radius
                                  : std::abs(dx) <= radius && std::abs(dy) <= radius;
          if (!inside || input.n(px, py) == 0) continue;
          double omega = 1.0;
          if (dx != 0 || dy != 0) {
            const double along = width_along(dx, dy, widths.beta, delta, options.eq12);
            omega = std::exp(-(dx * dx + dy * dy) / (2.0 * along * along));
          }
          if (options.weighting == FilterWeighting::kPerSample) omega *= input.n(px, py);
          total += omega;
          for (std::size_t c = 0; c < 3; ++c) {
            value[c] += omega * input.mean[c](px, py);
            variance[c] += omega * omega * input.variance[c](px, py);
          }
        }
      }
      if (total < 1e-300) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        out.image[c](x, y) = value[c] / total;
        out.variance[c](x, y) = variance[c] / (total * total);
      }
    }
  }
  return out;
}

// Single samples: every sample of every piece, nearest first or not.
template <class T>
RgbImage filter_samples(const FilterInput& input, const FilterWidths<T>& widths,
                        const SamplePool& pool, const FilterOptions& options) {
  RgbImage out = input.mean;
  const int q = pool.pieces_per_side();
  for (int y = 0; y < input.level.height(); ++y) {
    for (int x = 0; x < input.level.width(); ++x) {
      const int k = input.level(x, y);
      if (k == 0) continue;
      std::vector<double> delta;
      for (const auto& plane : widths.delta)
        delta.push_back(static_cast<double>(plane(x, y)));
      const int radius = 1 << (k - 1);
      double total = 0.0, value[3] = {};
      for (int py = 0; py < input.level.height(); ++py) {
        for (int px = 0; px < input.level.width(); ++px) {
          for (int s = 0; s < input.n(px, py); ++s) {
            const FilmPosition film = pool.film(px, py, s);
            const double dx = q * (px / q + static_cast<double>(film.x)) - (x + 0.5);
            const double dy = q * (py / q + static_cast<double>(film.y)) - (y + 0.5);
            const bool inside = options.window == FilterWindow::kDisc
                                    ? dx * dx + dy * dy <= radius * radius
                                    : std::abs(dx) <= radius && std::abs(dy) <= radius;
            if (!inside) continue;
            double omega = 1.0;
            if (dx != 0.0 || dy != 0.0) {
              const double along = width_along(dx, dy, widths.beta, delta, options.eq12);
              omega = std::exp(-(dx * dx + dy * dy) / (2.0 * along * along));
            }
            if (options.weighting == FilterWeighting::kPerPiece) omega /= input.n(px, py);
            total += omega;
            for (std::size_t c = 0; c < 3; ++c)
              value[c] += omega * static_cast<double>(pool.sample(px, py, s)[c]);
          }
        }
      }
      if (total < 1e-300) continue;
      for (std::size_t c = 0; c < 3; ++c)
        out[c](x, y) = value[c] / total;
    }
  }
  return out;
}

// Widths from the matched detail's bands and their energies.
inline FilterWidths<double> filter_widths(const Pyramid& pyramid, const Plane& variance,
                                          const CountImage& level,
                                          const DirectionalOptions& options) {
  const std::size_t bands = std::size_t{1} << options.bank.levels;
  const std::vector<double> angles = band_tangents(options.bank.levels);
  FilterWidths<double> result;
  result.delta.assign(bands, Plane(level.width(), level.height()));
  result.dominant = Plane(level.width(), level.height(), std::numeric_limits<double>::quiet_NaN());
  std::vector<std::size_t> order;  // insertion sort by angle
  for (std::size_t i = 0; i < bands; ++i) {
    std::size_t at = 0;
    while (at < order.size() && angles[order[at]] < angles[i])
      ++at;
    order.insert(order.begin() + static_cast<std::ptrdiff_t>(at), i);
  }
  for (const std::size_t i : order)
    result.beta.push_back(angles[i]);
  for (int k = 1; k <= options.pyramid.levels; ++k) {
    BankOptions bank = options.bank;
    bank.dilation = k < 2 ? 1 : 1 << (k - 2);
    const auto detail = static_cast<std::size_t>(k) - 1;
    const DirectionalEnergy<double> energy = reference::directional_energy(
        {reference::directional_bands(pyramid.detail[detail], bank),
         band_noise_gains(options.pyramid, bank, k, base_taps(options.base))},
        variance, k, options.energy);
    for (std::size_t p = 0; p < level.size(); ++p) {
      if (level[p] != k) continue;
      double largest = 0.0;
      for (const Plane& e : energy.energy)
        largest = std::fmax(largest, e[p]);
      for (std::size_t i = 0; i < bands; ++i) {
        const double q = energy.isotropic[p] ? 1.0 : energy.energy[order[i]][p] / largest;
        const double delta =
            options.width.sigma_max * std::pow(2.0, k) *
            (options.width.rho + (1.0 - options.width.rho) * std::pow(q, options.width.gamma_d));
        result.delta[i][p] = std::fmax(delta, 0.25);
        if (!energy.isotropic[p] && energy.energy[order[i]][p] == largest) {
          if (std::isnan(result.dominant[p])) result.dominant[p] = result.beta[i];
        }
      }
    }
  }
  return result;
}

}  // namespace spool::reference
