#include "lib/kernels/returned_residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/statistics/joined_halves.h"
#include "lib/statistics/window_sums.h"

namespace spool {
namespace {

constexpr double kLeastLuminance = 1e-3;  // in units of the scene's luminance
constexpr double kMostRatio = 16.0;
constexpr double kFine = 1.0;                // sigma, pixels
constexpr int kWide = 20;                    // radius, pixels
constexpr int kFirstHat = -6, kLastHat = 9;  // what is darker or brighter is of these

struct Ratios {
  Plane a, b;              // means of the halves' limited ratios
  Plane whole;             // mean of both halves' ratios
  Plane hat;               // log(I / U), within the hats
  std::vector<char> used;  // has samples in both halves
};

// 0: even, 1: odd. Of joined halves the half that took the sample, else its position.
std::size_t half_of(const Selection& selection, int px, int py, int i) {
  if (selection.halves_use != HalvesUse::kTogether || selection.halves.size() != 2)
    return static_cast<std::size_t>(i % 2);
  const std::vector<Selection>& halves = selection.halves;
  return static_cast<std::size_t>(
      half_of_joined(halves[0].statistics.n(px, py), halves[1].statistics.n(px, py), i));
}

Ratios ratios_of(const RgbImage& image, const Selection& selection, const SamplePool& pool,
                 double unit) {
  const int width = image[0].width(), height = image[0].height(), q = pool.pieces_per_side();
  const Plane empty(width, height);
  Ratios ratios{empty, empty, empty, empty, std::vector<char>(empty.size(), 0)};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const double own = luminance(image[0](x, y), image[1](x, y), image[2](x, y));
      if (!std::isfinite(own)) continue;
      const double bright = std::max(own, kLeastLuminance * unit);
      std::array<double, 2> limited{}, sum{};
      std::array<int, 2> count{};
      for (int py = y * q; py < (y + 1) * q; ++py) {
        for (int px = x * q; px < (x + 1) * q; ++px) {
          for (int i = 0; i < selection.statistics.n(px, py); ++i) {
            const Rgb value = pool.sample(px, py, i);
            const double ratio = luminance(value[0], value[1], value[2]) / bright;
            const std::size_t half = half_of(selection, px, py, i);
            limited[half] += std::min(ratio, kMostRatio);
            sum[half] += ratio;
            ++count[half];
          }
        }
      }
      if (count[0] == 0 || count[1] == 0) continue;
      const std::size_t p = empty.index(x, y);
      ratios.a[p] = limited[0] / count[0];
      ratios.b[p] = limited[1] / count[1];
      ratios.whole[p] = 0.5 * (sum[0] / count[0] + sum[1] / count[1]);
      ratios.hat[p] = std::clamp(std::log(bright / unit), static_cast<double>(kFirstHat),
                                 static_cast<double>(kLastHat));
      ratios.used[p] = 1;
    }
  });
  return ratios;
}

// W of the header. Of a pixel's hats, the one below its own level and the one above it.
class AboutAsBright {
 public:
  explicit AboutAsBright(const Ratios& ratios) : ratios_(ratios) {
    const Plane empty(ratios.hat.width(), ratios.hat.height());
    fine_.sums = wide_.sums = {empty, empty};
    for (int k = kFirstHat; k <= kLastHat; ++k) {
      Plane weight = empty;
      bool any = false;
      for (std::size_t p = 0; p < weight.size(); ++p) {
        weight[p] = weight_of(p, k);
        any = any || weight[p] > 0.0;
      }
      if (!any) continue;
      hats_.push_back(k);
      for (Window* window : {&fine_, &wide_}) {
        const Plane sum = window->sum(weight);
        for (std::size_t p = 0; p < sum.size(); ++p) {
          if (weight[p] > 0.0) window->sums[side_of(p, k)][p] = sum[p];
        }
      }
    }
  }
  Plane fine(const Plane& image) const { return mean(image, fine_); }
  Plane wide(const Plane& image) const { return mean(image, wide_); }
  // What mean() rests on in the wide window.
  Plane pixels() const {
    Plane count(ratios_.hat.width(), ratios_.hat.height());
    for (const int k : hats_) {
      for (std::size_t p = 0; p < count.size(); ++p) {
        const double weight = weight_of(p, k);
        if (weight > 0.0) count[p] += weight * wide_.sums[side_of(p, k)][p];
      }
    }
    return count;
  }

 private:
  struct Window {
    Plane (*sum)(const Plane& image);
    std::array<Plane, 2> sums;  // of the weights of the hats below and above
  };

  double weight_of(std::size_t p, int k) const {
    return ratios_.used[p] ? std::max(0.0, 1.0 - std::abs(ratios_.hat[p] - k)) : 0.0;
  }
  std::size_t side_of(std::size_t p, int k) const { return k > ratios_.hat[p] ? 1 : 0; }

  Plane mean(const Plane& image, const Window& window) const {
    Plane out(image.width(), image.height());
    for (const int k : hats_) {
      Plane weighted(image.width(), image.height());
      for (std::size_t p = 0; p < out.size(); ++p)
        weighted[p] = weight_of(p, k) * image[p];
      weighted = window.sum(weighted);
      for (std::size_t p = 0; p < out.size(); ++p) {
        const double weight = weight_of(p, k);
        if (weight > 0.0) out[p] += weight * weighted[p] / window.sums[side_of(p, k)][p];
      }
    }
    return out;
  }

  const Ratios& ratios_;
  Window fine_{[](const Plane& image) { return truncated_sum(image, four_sigma_taps(kFine)); }, {}};
  Window wide_{[](const Plane& image) { return window_sums(image, kWide); }, {}};
  std::vector<int> hats_;  // those that have pixels
};

Plane difference(Plane a, const Plane& b) {
  for (std::size_t p = 0; p < a.size(); ++p)
    a[p] -= b[p];
  return a;
}

double minmod(double a, double b) {
  if (a > 0.0 && b > 0.0) return std::min(a, b);
  if (a < 0.0 && b < 0.0) return std::max(a, b);
  return 0.0;
}

}  // namespace

RgbImage return_residual(RgbImage image, const Selection& selection, const SamplePool& pool,
                         double unit, GuardCounts& guards) {
  for (std::size_t p = 0; p < image[0].size(); ++p) {
    if (!std::isfinite(luminance(image[0][p], image[1][p], image[2][p])))
      guards.add(Guard::kResidualNotFinite);
  }
  const Ratios ratios = ratios_of(image, selection, pool, unit);
  const AboutAsBright means(ratios);
  const Plane a = difference(means.fine(ratios.a), means.wide(ratios.a));
  const Plane b = difference(means.fine(ratios.b), means.wide(ratios.b));
  const Plane whole = means.fine(ratios.whole);
  Plane product = a, noise = a;
  for (std::size_t p = 0; p < a.size(); ++p) {
    product[p] = a[p] * b[p];
    noise[p] = 0.25 * (a[p] - b[p]) * (a[p] - b[p]);
  }
  const Plane agreed = means.wide(product), wide_noise = means.wide(noise);
  const Plane fine_noise = means.fine(noise), pixels = means.pixels();
  for (std::size_t p = 0; p < a.size(); ++p) {
    if (!ratios.used[p]) continue;
    const double bias = agreed[p] - (agreed[p] + wide_noise[p]) / std::sqrt(pixels[p]);
    if (bias <= 0.0) continue;
    const double share = bias / (bias + std::max(wide_noise[p], fine_noise[p]));
    const double factor = 1.0 + share * minmod(0.5 * (a[p] + b[p]), whole[p] - 1.0);
    for (Plane& channel : image)
      channel[p] *= factor;
  }
  return image;
}

}  // namespace spool
