// Slow twin of lib/kernels/cross_bilateral.h and of its features: one pixel and one pair at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lib/kernels/cross_bilateral.h"

namespace spool::reference {

struct Feature {
  std::string name;
  std::vector<Plane> mean;  // [c][y][x]
  Plane variance;           // of the samples, mean over channels
};

// All samples counted alike; every piece has at least 4, so nothing is pooled. q = 1.
inline std::vector<Feature> features(const SamplePool& pool, const CountImage& n) {
  std::vector<Feature> result;
  const RecordedSamples& recording = pool.recording();
  const int width = n.width(), height = n.height(), spp = recording.spp();
  for (const FeatureLayer& layer : recording.features()) {
    const auto values = *recording.read_feature(layer, {0, 0, width, height}, spp);
    const std::size_t channels = layer.components.size();
    Feature feature{layer.name, std::vector<Plane>(channels, Plane(width, height)),
                    Plane(width, height)};
    double largest = 0.0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int count = n(x, y);
        for (std::size_t c = 0; c < channels; ++c) {
          const auto value = [&](int i) {
            return static_cast<double>(
                values[((c * height + y) * width + x) * spp +
                       static_cast<std::size_t>(pool.recorded_index(x, y, i))]);
          };
          double mean = 0.0, squares = 0.0;
          for (int i = 0; i < count; ++i)
            mean += value(i) / count;
          for (int i = 0; i < count; ++i)
            squares += (value(i) - mean) * (value(i) - mean);
          feature.mean[c](x, y) = mean;
          feature.variance(x, y) += squares / (count - 1) / static_cast<double>(channels);
          largest = std::max(largest, std::abs(mean));
        }
      }
    }
    if (layer.name == "depth") {
      for (std::size_t i = 0; i < feature.variance.size(); ++i) {
        feature.mean[0][i] /= largest;
        feature.variance[i] /= largest * largest;
      }
    }
    result.push_back(std::move(feature));
  }
  return result;
}

struct CrossBilateral {
  std::vector<RgbImage> filtered;  // F_s of the means
  std::vector<Plane> risk;         // smoothed
};

inline CrossBilateral cross_bilateral(const RgbImage& mean, const RgbImage& variance,
                                      const std::vector<Feature>& features,
                                      const CrossBilateralOptions& options) {
  const int width = mean[0].width(), height = mean[0].height();
  // The small pixel filter, cut at the border.
  const double taps[2] = {1.0 - std::exp(-8.0), std::exp(-2.0) - std::exp(-8.0)};
  RgbImage y = mean, v = variance;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int py = 0; py < height; ++py) {
      for (int px = 0; px < width; ++px) {
        double total = 0.0, value = 0.0, squares = 0.0;
        for (int qy = std::max(0, py - 1); qy <= std::min(height - 1, py + 1); ++qy) {
          for (int qx = std::max(0, px - 1); qx <= std::min(width - 1, px + 1); ++qx) {
            const double w = taps[std::abs(qx - px)] * taps[std::abs(qy - py)];
            total += w;
            value += w * mean[c](qx, qy);
            squares += w * w * variance[c](qx, qy);
          }
        }
        y[c](px, py) = value / total;
        v[c](px, py) = squares / (total * total);
      }
    }
  }
  const auto weight = [&](int px, int py, int qx, int qy, double s) {
    double exponent = ((px - qx) * (px - qx) + (py - qy) * (py - qy)) / (2.0 * s * s);
    for (const Feature& f : features) {
      double squared = 0.0;
      for (const Plane& channel : f.mean)
        squared += (channel(px, py) - channel(qx, qy)) * (channel(px, py) - channel(qx, qy));
      const double sigma = f.name == "normal"   ? options.sigma_normal
                           : f.name == "albedo" ? options.sigma_albedo
                                                : options.sigma_depth;
      exponent +=
          squared / (2.0 * sigma * sigma * std::max(f.variance(px, py) + f.variance(qx, qy), 1e-2));
    }
    return std::exp(-exponent);
  };
  // Weighted mean of `plane` around a pixel, and the sum of the weights.
  const auto filter = [&](const Plane& plane, int px, int py, double s, double& total) {
    const int r = static_cast<int>(std::lround(2.0 * s));
    double value = 0.0;
    total = 0.0;
    for (int qy = std::max(0, py - r); qy <= std::min(height - 1, py + r); ++qy) {
      for (int qx = std::max(0, px - r); qx <= std::min(width - 1, px + r); ++qx) {
        const double w = weight(px, py, qx, qy, s);
        total += w;
        value += w * plane(qx, qy);
      }
    }
    return value / total;
  };
  CrossBilateral result;
  for (const double s : options.scales) {
    RgbImage filtered = mean;
    Plane risk(width, height), smoothed(width, height);
    for (int py = 0; py < height; ++py) {
      for (int px = 0; px < width; ++px) {
        for (std::size_t c = 0; c < 3; ++c) {
          double total = 1.0, f = y[c](px, py);
          if (s > 0.0) {
            filtered[c](px, py) = filter(mean[c], px, py, s, total);
            f = filter(y[c], px, py, s, total);
          }
          const double d = f - y[c](px, py), noise = v[c](px, py);
          risk(px, py) += (d * d + 2.0 * noise / total - noise) / 3.0;
        }
      }
    }
    double total = 0.0;
    for (int py = 0; py < height; ++py) {
      for (int px = 0; px < width; ++px)
        smoothed(px, py) = filter(risk, px, py, options.risk_scale, total);
    }
    result.filtered.push_back(std::move(filtered));
    result.risk.push_back(std::move(smoothed));
  }
  return result;
}

}  // namespace spool::reference
