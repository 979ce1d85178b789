// Slow twin of the returned residual: every mean a double loop over the whole image.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#include "lib/core/image.h"

namespace spool::reference {

// [y * width + x]: luminances of the samples of each half.
struct HalvesOfPixel {
  std::vector<double> even, odd;
};

inline double mean_of_ratios(const std::vector<double>& samples, double own, double most) {
  double sum = 0.0;
  for (const double sample : samples)
    sum += std::min(sample / own, most);
  return sum / static_cast<double>(samples.size());
}

inline RgbImage return_residual(const RgbImage& image, const std::vector<HalvesOfPixel>& samples,
                                double unit) {
  const int width = image[0].width(), height = image[0].height();
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * width + x; };
  const auto luminance_at = [&](int x, int y) {
    return luminance(image[0](x, y), image[1](x, y), image[2](x, y));
  };
  const auto used = [&](int x, int y) {
    const HalvesOfPixel& own = samples[at(x, y)];
    return std::isfinite(luminance_at(x, y)) && !own.even.empty() && !own.odd.empty();
  };
  const auto bright = [&](int x, int y) { return std::max(luminance_at(x, y), 0.001 * unit); };
  const auto level = [&](int x, int y) {
    return std::clamp(std::log(bright(x, y) / unit), -6.0, 9.0);
  };
  using Value = std::function<double(int, int)>;
  // Under each of the two hats over the pixel's own level, interpolated.
  const auto about_as_bright = [&](int radius, double sigma, const Value& value,
                                   bool of_weights = false) {
    Plane out(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!used(x, y)) continue;
        const double below = std::floor(level(x, y)), above_share = level(x, y) - below;
        for (const double hat : {below, below + 1.0}) {
          double sum = 0.0, weights = 0.0;
          for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
            for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
              if (!used(u, v)) continue;
              const double d2 = (u - x) * (u - x) + (v - y) * (v - y);
              const double w = std::exp(-d2 / (2.0 * sigma * sigma)) *
                               std::max(0.0, 1.0 - std::abs(level(u, v) - hat));
              sum += w * value(u, v);
              weights += w;
            }
          }
          const double share = hat == below ? 1.0 - above_share : above_share;
          if (share > 0.0) out(x, y) += share * (of_weights ? weights : sum / weights);
        }
      }
    }
    return out;
  };
  const auto fine_mean = [&](const Value& value) { return about_as_bright(4, 1.0, value); };
  const auto wide_mean = [&](const Value& value) { return about_as_bright(20, INFINITY, value); };
  const auto residual = [&](bool odd) {
    const Value ratio = [&, odd](int x, int y) {
      const HalvesOfPixel& own = samples[at(x, y)];
      return mean_of_ratios(odd ? own.odd : own.even, bright(x, y), 16.0);
    };
    Plane fine = fine_mean(ratio);
    const Plane wide = wide_mean(ratio);
    for (std::size_t p = 0; p < fine.size(); ++p)
      fine[p] -= wide[p];
    return fine;
  };
  const Plane a = residual(false), b = residual(true);
  const Plane whole = fine_mean([&](int x, int y) {
    const HalvesOfPixel& own = samples[at(x, y)];
    return (mean_of_ratios(own.even, bright(x, y), INFINITY) +
            mean_of_ratios(own.odd, bright(x, y), INFINITY)) /
           2.0;
  });
  const Value product = [&](int x, int y) { return a(x, y) * b(x, y); };
  const Value noise = [&](int x, int y) { return std::pow((a(x, y) - b(x, y)) / 2.0, 2); };
  const Plane agreed = wide_mean(product), wide = wide_mean(noise);
  const Plane fine = fine_mean(noise), pixels = about_as_bright(20, INFINITY, noise, true);
  RgbImage out = image;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!used(x, y)) continue;
      const double bias =
          std::max(0.0, agreed(x, y) - (agreed(x, y) + wide(x, y)) / std::sqrt(pixels(x, y)));
      if (bias == 0.0) continue;
      const double limited = (a(x, y) + b(x, y)) / 2.0, plain = whole(x, y) - 1.0;
      double step = std::abs(limited) < std::abs(plain) ? limited : plain;
      if (limited * plain <= 0.0) step = 0.0;
      for (Plane& channel : out)
        channel(x, y) *= 1.0 + bias / (bias + std::max(wide(x, y), fine(x, y))) * step;
    }
  }
  return out;
}

}  // namespace spool::reference
