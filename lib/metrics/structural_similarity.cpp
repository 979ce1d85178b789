#include "lib/metrics/structural_similarity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/core/parallel.h"
#include "lib/metrics/weighted_rows.h"

namespace spool {
namespace {

constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

std::vector<double> gaussian_window(int size) {
  std::vector<double> taps(static_cast<std::size_t>(size));
  double sum = 0.0;
  for (int i = 0; i < size; ++i) {
    const double d = i - size / 2;
    taps[static_cast<std::size_t>(i)] = std::exp(-d * d / (2.0 * kSigma * kSigma));
    sum += taps[static_cast<std::size_t>(i)];
  }
  for (double& tap : taps)
    tap /= sum;
  return taps;
}

// Window means wherever the window fits, NaN elsewhere.
Plane window_mean(const Plane& image, const std::vector<double>& taps) {
  const int width = image.width(), height = image.height();
  const int reach = static_cast<int>(taps.size()) / 2, fitting = width - 2 * reach;
  Plane rows(width, height), mean(width, height, std::numeric_limits<double>::quiet_NaN());
  const auto add = [&](const auto& start_of, double* to) {
    std::vector<const double*> from;
    for (int i = 0; i <= 2 * reach; ++i)
      from.push_back(start_of(i));
    add_rows(taps, from, to, fitting);
  };
  parallel_rows(0, height,
                [&](int y) { add([&](int i) { return &image(0, y) + i; }, &rows(0, y) + reach); });
  parallel_rows(reach, height - reach, [&](int y) {
    add([&](int i) { return &rows(0, y - reach + i) + reach; }, &mean(0, y) + reach);
  });
  return mean;
}

Plane product(const Plane& a, const Plane& b) {
  Plane result(a.width(), a.height());
  for (std::size_t p = 0; p < result.size(); ++p)
    result[p] = a[p] * b[p];
  return result;
}

Plane halved(const Plane& image) {
  Plane half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      half(x, y) = 0.25 * (image(2 * x, 2 * y) + image(2 * x + 1, 2 * y) + image(2 * x, 2 * y + 1) +
                           image(2 * x + 1, 2 * y + 1));
    }
  }
  return half;
}

}  // namespace

int ssim_window(int width, int height) {
  const int side = std::min({width, height, kSsimWindow});
  return side % 2 == 1 ? side : side - 1;
}

SimilarityMaps ssim_maps(const Plane& a, const Plane& b) {
  SPOOL_CHECK(a.same_size(b));
  const std::vector<double> taps = gaussian_window(ssim_window(a.width(), a.height()));
  const Plane mean_a = window_mean(a, taps), mean_aa = window_mean(product(a, a), taps);
  const Plane mean_b = window_mean(b, taps), mean_bb = window_mean(product(b, b), taps);
  const Plane mean_ab = window_mean(product(a, b), taps);
  SimilarityMaps maps{Plane(a.width(), a.height()), Plane(a.width(), a.height())};
  for (std::size_t p = 0; p < a.size(); ++p) {
    const double ma = mean_a[p], mb = mean_b[p];
    const double variance_a = mean_aa[p] - ma * ma, variance_b = mean_bb[p] - mb * mb;
    const double covariance = mean_ab[p] - ma * mb;
    const double cs = (2.0 * covariance + kC2) / (variance_a + variance_b + kC2);
    maps.contrast_structure[p] = cs;
    maps.ssim[p] = cs * (2.0 * ma * mb + kC1) / (ma * ma + mb * mb + kC1);
  }
  return maps;
}

int ms_ssim_scales(int width, int height) {
  int scales = 1;
  while (scales < 5 && (std::min(width, height) >> scales) >= kSsimWindow)
    ++scales;
  return scales;
}

std::vector<double> ms_ssim_weights(int scales) {
  const double published[] = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
  SPOOL_CHECK_LE(scales, 5);
  std::vector<double> weights(published, published + scales);
  double sum = 0.0;
  for (const double w : weights)
    sum += w;
  for (double& w : weights)
    w /= sum;
  return weights;
}

std::vector<SimilarityMaps> ms_ssim_maps(Plane a, Plane b, int most) {
  std::vector<SimilarityMaps> maps;
  const int scales = std::min(most, ms_ssim_scales(a.width(), a.height()));
  for (int j = 0; j < scales; ++j) {
    if (j > 0) {
      a = halved(a);
      b = halved(b);
    }
    maps.push_back(ssim_maps(a, b));
  }
  return maps;
}

double ms_ssim_value(const std::vector<double>& scale_means, const std::vector<double>& weights) {
  SPOOL_CHECK_EQ(scale_means.size(), weights.size());
  double product = 1.0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    if (std::isnan(scale_means[j])) return scale_means[j];
    product *= std::pow(std::max(scale_means[j], 0.0), weights[j]);
  }
  return product;
}

}  // namespace spool
