// Slow twin of lib/filters/greedy_selection.h: two-dimensional sums over cut windows.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool::reference {

// A one-dimensional kernel over offsets in cells of 1 / cells pixels; offset o sits at o + shift.
using Kernel = std::map<int, double>;

inline Kernel greedy_pixel_filter(bool subpixel) {
  Kernel kernel;
  double sum = 0.0;
  if (subpixel) {
    for (int i = 0; i < 20; ++i) {
      const double d = (i + 0.5 - 10) / 4.0;
      sum += kernel[i - 10] = std::max(0.0, std::exp(-2 * d * d) - std::exp(-8.0));
    }
  } else {
    for (int d = -1; d <= 1; ++d)
      sum += kernel[d] = std::exp(-2.0 * d * d) - std::exp(-8.0);
  }
  for (auto& [o, tap] : kernel)
    tap /= sum;
  return kernel;
}

inline Kernel greedy_gaussian(double sigma) {
  Kernel kernel;
  double sum = 0.0;
  const int radius = static_cast<int>(std::floor(3 * sigma));
  for (int d = -radius; d <= radius; ++d)
    sum += kernel[d] = std::exp(-d * d / (2 * sigma * sigma));
  for (auto& [o, tap] : kernel)
    tap /= sum;
  return kernel;
}

inline Kernel convolved(const Kernel& a, int stretch, const Kernel& b) {
  Kernel kernel;
  for (const auto& [i, x] : a) {
    for (const auto& [j, y] : b)
      kernel[stretch * i + j] += x * y;
  }
  return kernel;
}

// Tap and variance tap of every pixel at an offset, from a kernel over cells.
struct PixelTaps {
  Kernel taps, squares;
};
inline PixelTaps per_pixel(const Kernel& kernel, bool subpixel) {
  PixelTaps result;
  for (const auto& [o, tap] : kernel) {
    const int pixel = subpixel ? static_cast<int>(std::floor((o + 2) / 4.0)) : o;
    result.taps[pixel] += tap;
    result.squares[pixel] += (subpixel ? 4.0 : 1.0) * tap * tap;
  }
  return result;
}

// sum of weights(dx) weights(dy) image / (sum of taps(dx) taps(dy))^power over pixels inside.
inline Plane cut_sum(const Plane& image, const Kernel& weights, const Kernel& taps, int power) {
  Plane out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0.0, inside = 0.0;
      for (const auto& [dy, wy] : weights) {
        for (const auto& [dx, wx] : weights) {
          if (!image.bounds().contains(x + dx, y + dy)) continue;
          sum += wx * wy * image(x + dx, y + dy);
          inside += taps.at(dx) * taps.at(dy);
        }
      }
      out(x, y) = sum / std::pow(inside, power);
    }
  }
  return out;
}

struct GreedySelection {
  RgbImage image, variance;
  CountImage level;
  Plane margin;  // how close a decision came to tipping over, relative
};

// The pixel image under the pixel filter; cells [c][4 height][4 width], or null on the pixel grid.
inline RgbImage greedy_base(const RgbImage& mean, const RgbImage* cells) {
  const Kernel g = greedy_pixel_filter(cells != nullptr);
  const int width = mean[0].width(), height = mean[0].height();
  RgbImage base = mean;
  for (std::size_t c = 0; c < 3; ++c) {
    if (cells == nullptr) {
      base[c] = cut_sum(mean[c], g, g, 1);
      continue;
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0.0, inside = 0.0;
        for (const auto& [dy, wy] : g) {
          for (const auto& [dx, wx] : g) {
            const int cx = 4 * x + 2 + dx, cy = 4 * y + 2 + dy;
            if (!(*cells)[c].bounds().contains(cx, cy)) continue;
            sum += wx * wy * (*cells)[c](cx, cy);
            inside += wx * wy;
          }
        }
        base[c](x, y) = sum / inside;
      }
    }
  }
  return base;
}

// mean, variance, n: of pixels; cells [c][4 height][4 width] on the subpixel grid, else unused.
inline GreedySelection greedy_selection(const RgbImage& mean, const RgbImage& variance,
                                        const Plane& n, const RgbImage* cells, int scales,
                                        double gamma, double alpha) {
  const bool subpixel = cells != nullptr;
  const int width = n.width(), height = n.height();
  const Kernel g = greedy_pixel_filter(subpixel), g_pixel = greedy_pixel_filter(false);
  GreedySelection out;
  const RgbImage base = greedy_base(mean, cells);
  RgbImage fine = base, fine_variance = variance;
  const PixelTaps base_taps = per_pixel(g, subpixel);
  for (std::size_t c = 0; c < 3; ++c)
    fine_variance[c] = cut_sum(variance[c], base_taps.squares, base_taps.taps, 2);
  out.image = fine;
  out.variance = fine_variance;
  out.level = CountImage(width, height);
  out.margin = Plane(width, height, 1.0);
  CountImage stopped(width, height);
  for (int s = 1; s <= scales; ++s) {
    const double sigma = std::pow(2.0, (s - 2) / 2.0), before = std::pow(2.0, (s - 3) / 2.0);
    const Kernel gauss = greedy_gaussian(sigma);
    const PixelTaps kernel = per_pixel(convolved(gauss, subpixel ? 4 : 1, g), subpixel);
    RgbImage coarse = base, coarse_variance = variance;
    for (std::size_t c = 0; c < 3; ++c) {
      coarse[c] = cut_sum(base[c], gauss, gauss, 1);
      coarse_variance[c] = cut_sum(variance[c], kernel.squares, kernel.taps, 2);
    }
    Plane samples(width, height);
    if (s == 1) {
      const Kernel& taps = base_taps.taps;
      Kernel peak = taps;
      for (auto& [o, tap] : peak)
        tap /= taps.at(0);
      samples = cut_sum(n, peak, peak, 0);
    } else {
      samples = cut_sum(n, kernel.taps, kernel.taps, 1);
    }
    const double beta =
        s == 1 ? 1.0 : (sigma * sigma + before * before) / (sigma * sigma - before * before);
    Plane stop(width, height);
    for (std::size_t i = 0; i < stop.size(); ++i) {
      const double z = -std::log(1 - std::pow(1.9 * gamma, 1 / std::sqrt(2.0))) *
                       (1 - 1 / std::max(samples[i], 1.0001));
      double loss = 0.0, gain = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        loss += z * beta * std::pow(coarse[c][i] - fine[c][i], 2);
        gain += fine_variance[c][i] - coarse_variance[c][i];
      }
      stop[i] = loss - gain >= 0.0 ? 1.0 : 0.0;
      out.margin[i] =
          std::min(out.margin[i], std::abs(loss - gain) / (std::abs(loss) + std::abs(gain)));
    }
    const Kernel blur = convolved(greedy_gaussian(alpha * sigma), 1, g_pixel);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
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
        if (stop(x, y) > 0.0 && vote >= 0.5 - 1e-9) stopped(x, y) = 1;
        if (stopped(x, y) == 0) {
          out.level(x, y) = s;
          for (std::size_t c = 0; c < 3; ++c) {
            out.image[c](x, y) = coarse[c](x, y);
            out.variance[c](x, y) = coarse_variance[c](x, y);
          }
        }
      }
    }
    fine = coarse;
    fine_variance = coarse_variance;
  }
  return out;
}

}  // namespace spool::reference
