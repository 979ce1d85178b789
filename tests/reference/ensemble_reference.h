// Slow twin of the weights of an ensemble: what they minimise, written from its formulas
// (lib/filters/ensemble_weights.h); windows as double loops over the whole image.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "lib/core/image.h"
#include "tests/reference/energy_step_reference.h"

namespace spool::reference {

using Halves = std::array<RgbImage, 2>;

inline Plane mean_inside(const Plane& image, double sigma) {
  Plane sum = gaussian_inside(image, sigma);
  const Plane all = gaussian_inside(Plane(image.width(), image.height(), 1.0), sigma);
  for (std::size_t p = 0; p < sum.size(); ++p)
    sum[p] /= all[p];
  return sum;
}

inline Plane luminance_plane(const RgbImage& image) {
  Plane out = image[0];
  for (std::size_t p = 0; p < out.size(); ++p)
    out[p] = luminance(image[0][p], image[1][p], image[2][p]);
  return out;
}

// w'(M + t I) w - 2 (r + t / K)'w of each pixel.
struct EnsembleError {
  std::vector<std::vector<Plane>> m;  // [j][k], with t
  std::vector<Plane> r;               // [k], with t / K

  double operator()(const std::vector<double>& w, std::size_t p) const {
    double value = 0.0;
    for (std::size_t j = 0; j < w.size(); ++j) {
      value -= 2.0 * r[j][p] * w[j];
      for (std::size_t k = 0; k < w.size(); ++k)
        value += w[j] * w[k] * m[j][k][p];
    }
    return value;
  }
};

inline EnsembleError ensemble_error(const std::vector<Halves>& parts, const Halves& means,
                                    double l) {
  const std::size_t count = parts.size();
  const Plane zero(means[0][0].width(), means[0][0].height());
  Halves mean = {RgbImage{zero, zero, zero}, RgbImage{zero, zero, zero}}, judge = means;
  RgbImage picture = mean[0], shape = mean[0];
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < zero.size(); ++p) {
      for (std::size_t h = 0; h < 2; ++h) {
        for (const Halves& part : parts)
          mean[h][c][p] += part[h][c][p] / static_cast<double>(count);
      }
      picture[c][p] = std::max(0.0, (mean[0][c][p] + mean[1][c][p]) / 2.0);
      shape[c][p] = picture[c][p] + 0.1 * l;
    }
  }
  const Plane near = mean_inside(luminance_plane(picture), 1.0);
  const Plane far = mean_inside(luminance_plane(shape), 16.0);
  const Plane level = mean_inside(luminance_plane(picture), 16.0);
  for (std::size_t h = 0; h < 2; ++h) {
    const Plane before = luminance_plane(means[h]);
    Plane lost = before;
    for (std::size_t p = 0; p < zero.size(); ++p) {
      const double top = 20.0 * (near[p] + 0.1 * l);
      const double factor = before[p] > top ? top / before[p] : 1.0;
      lost[p] = (1.0 - factor) * before[p];
      for (std::size_t c = 0; c < 3; ++c)
        judge[h][c][p] *= factor;
    }
    lost = mean_inside(lost, 16.0);
    const Plane left = mean_inside(luminance_plane(judge[h]), 16.0);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < zero.size(); ++p) {
        const double back = std::clamp(level[p] - left[p], 0.0, lost[p]);
        judge[h][c][p] += shape[c][p] * back / far[p];
      }
    }
  }
  EnsembleError error{std::vector(count, std::vector<Plane>(count, zero)),
                      std::vector<Plane>(count, zero)};
  for (std::size_t p = 0; p < zero.size(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double ma = mean[0][c][p], mb = mean[1][c][p];
      const double omega = 1.0 / (picture[c][p] * picture[c][p] + 0.01 * l * l);
      for (std::size_t j = 0; j < count; ++j) {
        const double aj = parts[j][0][c][p] - ma, bj = parts[j][1][c][p] - mb;
        error.r[j][p] += omega * (aj * (judge[1][c][p] - ma) + bj * (judge[0][c][p] - mb) +
                                  (aj - bj) * (ma - mb) / 2.0);
        for (std::size_t k = 0; k < count; ++k) {
          const double ak = parts[k][0][c][p] - ma, bk = parts[k][1][c][p] - mb;
          error.m[j][k][p] += omega * (aj * ak + bj * bk - (aj - bj) * (ak - bk) / 2.0);
        }
      }
    }
  }
  for (std::size_t j = 0; j < count; ++j) {
    error.r[j] = mean_inside(error.r[j], 16.0);
    for (std::size_t k = 0; k < count; ++k)
      error.m[j][k] = mean_inside(error.m[j][k], 16.0);
  }
  for (std::size_t p = 0; p < zero.size(); ++p) {
    double diagonal = 0.0;
    for (std::size_t k = 0; k < count; ++k)
      diagonal += std::max(0.0, error.m[k][k][p]);
    const double t = diagonal / (4.0 * static_cast<double>(count));
    for (std::size_t k = 0; k < count; ++k) {
      error.m[k][k][p] += t;
      error.r[k][p] += t / static_cast<double>(count);
    }
  }
  return error;
}

}  // namespace spool::reference
