// Slow twin of the error map of lib/sampling/greedy_error.h: two-dimensional sums over cut windows.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/reference/greedy_selection_reference.h"

namespace spool::reference {

struct GreedyError {
  Plane error;
  CountImage scale;
  Plane margin;  // how close a decision came to tipping over
};

// mean, variance, n: of pixels, radiance units; cells [c][4 height][4 width] on the subpixel grid.
inline GreedyError greedy_error(const RgbImage& mean, const RgbImage& variance, const Plane& n,
                                const RgbImage* cells, double exposure, double m, int scales,
                                double gamma, double alpha) {
  const bool subpixel = cells != nullptr;
  const int width = n.width(), height = n.height();
  const Kernel g = greedy_pixel_filter(subpixel), g_pixel = greedy_pixel_filter(false);
  const RgbImage base = greedy_base(mean, cells);
  GreedyError out{Plane(width, height), CountImage(width, height), Plane(width, height, 1.0)};
  Plane mse(width, height);
  CountImage stopped(width, height);
  RgbImage fine = base, fine_variance = variance;
  for (int s = 0; s <= scales; ++s) {
    const double sigma = s == 0 ? 0.0 : std::pow(2.0, s - 1);
    const Kernel gauss = s == 0 ? Kernel{{0, 1.0}} : greedy_gaussian(sigma);
    const PixelTaps kernel = per_pixel(convolved(gauss, subpixel ? 4 : 1, g), subpixel);
    Kernel peak = kernel.taps;
    const double middle = peak.at(0);
    for (auto& [o, tap] : peak)
      tap /= middle;
    const Plane under = cut_sum(n, peak, peak, 0);
    RgbImage image = base, image_variance = variance;
    for (std::size_t c = 0; c < 3; ++c) {
      image[c] = cut_sum(base[c], gauss, gauss, 1);
      image_variance[c] = cut_sum(variance[c], kernel.squares, kernel.taps, 2);
    }
    Plane stop(width, height);
    if (s > 0) {
      const double before = sigma / 2;
      const double beta =
          s == 1 ? 1.0 : (sigma * sigma + before * before) / (sigma * sigma - before * before);
      // N of the first transition is that of the base image.
      const PixelTaps base_taps = per_pixel(g, subpixel);
      Kernel base_peak = base_taps.taps;
      for (auto& [o, tap] : base_peak)
        tap /= base_taps.taps.at(0);
      const Plane samples =
          s == 1 ? cut_sum(n, base_peak, base_peak, 0) : cut_sum(n, kernel.taps, kernel.taps, 1);
      for (std::size_t i = 0; i < stop.size(); ++i) {
        const double z = -std::log(1 - std::pow(1.9 * gamma, 1 / std::sqrt(2.0))) *
                         (1 - 1 / std::max(samples[i], 1.0001));
        double loss = 0.0, gain = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          loss += beta * std::pow(image[c][i] - fine[c][i], 2);
          gain += fine_variance[c][i] - image_variance[c][i];
        }
        stop[i] = z * loss - gain >= 0.0 ? 1.0 : 0.0;
        mse[i] += (loss - gain) / 3;
        out.margin[i] = std::min(out.margin[i],
                                 std::abs(z * loss - gain) / (std::abs(z * loss) + std::abs(gain)));
      }
    }
    const Kernel blur = convolved(greedy_gaussian(std::max(alpha * sigma, 0.5)), 1, g_pixel);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (s == 0) {
          for (std::size_t c = 0; c < 3; ++c)
            mse(x, y) += image_variance[c](x, y) / 3;
        } else {
          double sum = 0.0, inside = 0.0;
          for (const auto& [dy, wy] : blur) {
            for (const auto& [dx, wx] : blur) {
              if (!stop.bounds().contains(x + dx, y + dy)) continue;
              sum += wx * wy * stop(x + dx, y + dy);
              inside += wx * wy;
            }
          }
          const double own = std::max(0.0, blur.at(0) * blur.at(0) / inside - 0.01);
          const double vote = own < 0.99 ? (sum / inside - own * stop(x, y)) / (1 - own) : 1.0;
          out.margin(x, y) = std::min(out.margin(x, y), std::abs(vote - 0.5 + 1e-9));
          if (vote >= 0.5 - 1e-9) stopped(x, y) = 1;
        }
        if (stopped(x, y)) continue;
        out.scale(x, y) = s;
        const double value = exposure * (image[0](x, y) + image[1](x, y) + image[2](x, y)) / 3;
        out.error(x, y) = std::max(mse(x, y), 0.0) * exposure * exposure / (0.1 + value * value) *
                          m / (m + under(x, y));
      }
    }
    fine = image;
    fine_variance = image_variance;
  }
  return out;
}

}  // namespace spool::reference
