// Slow twin of lib/metrics/error_metrics: each metric by its definition, one plain loop each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lib/metrics/error_metrics.h"

namespace spool::reference {

// One judged pixel: [c] of estimate, reference, its variance and the denominator image.
struct JudgedPixel {
  double i[3], r[3], b[3], d[3];
  double y_r() const { return 0.2126 * r[0] + 0.7152 * r[1] + 0.0722 * r[2]; }
  double y_d() const { return 0.2126 * d[0] + 0.7152 * d[1] + 0.0722 * d[2]; }
};

inline std::vector<JudgedPixel> judged_pixels(const RgbImage& estimate,
                                              const JudgingReference& reference) {
  std::vector<JudgedPixel> pixels;
  for (int y = 0; y < estimate[0].height(); ++y) {
    for (int x = 0; x < estimate[0].width(); ++x) {
      JudgedPixel p{};
      bool finite = true;
      for (std::size_t c = 0; c < 3; ++c) {
        p.i[c] = estimate[c](x, y);
        p.r[c] = reference.mean[c](x, y);
        p.b[c] = reference.variance ? (*reference.variance)[c](x, y) : 0.0;
        p.d[c] = reference.denominator ? (*reference.denominator)[c](x, y) : p.r[c];
        finite = finite && std::isfinite(p.i[c] + p.r[c] + p.b[c] + p.d[c]);
      }
      if (finite) pixels.push_back(p);
    }
  }
  const bool same = std::all_of(pixels.begin(), pixels.end(),
                                [](const JudgedPixel& p) { return std::equal(p.i, p.i + 3, p.r); });
  for (JudgedPixel& p : pixels)  // the reference itself is not debiased
    if (same) p.b[0] = p.b[1] = p.b[2] = 0.0;
  return pixels;
}

using PixelTerm = std::function<double(const JudgedPixel&, int)>;

inline double mean_of(const std::vector<JudgedPixel>& pixels, const PixelTerm& term) {
  long double sum = 0;
  for (const JudgedPixel& p : pixels) {
    for (int c = 0; c < 3; ++c)
      sum += term(p, c);
  }
  return static_cast<double>(sum / 3 / static_cast<long double>(pixels.size()));
}

inline double relative_factor(const std::vector<JudgedPixel>& pixels, const MetricOptions& o) {
  if (o.rel_scale == RelativeScale::kNone) return 1.0;
  long double sum = 0;
  for (const JudgedPixel& p : pixels)
    sum += p.y_r();
  return static_cast<double>(static_cast<long double>(pixels.size()) / sum);
}

inline double relative_term(const JudgedPixel& p, int c, double scale, const MetricOptions& o) {
  const double d =
      scale * (o.rel_denominator == RelativeDenominator::kLuminance ? p.y_d() : p.d[c]);
  const double difference = scale * p.i[c] - scale * p.r[c];
  return (difference * difference - scale * scale * p.b[c]) / (d * d + o.rel_eps);
}

inline double tone(double v, double exposure) {
  const double x = std::min(1.0, std::max(0.0, exposure * v));
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

// Metrics that are means over pixels and channels; NaN for any other name.
inline double linear_metric(const std::string& name, const std::vector<JudgedPixel>& pixels,
                            const MetricOptions& o) {
  const double scale = relative_factor(pixels, o);
  const PixelTerm squared = [](const JudgedPixel& p, int c) {
    return (p.i[c] - p.r[c]) * (p.i[c] - p.r[c]) - p.b[c];
  };
  const PixelTerm relative = [&](const JudgedPixel& p, int c) {
    return relative_term(p, c, scale, o);
  };
  const auto of_channel = [&](const PixelTerm& term, int channel) {
    return 3 * mean_of(pixels, [&](const JudgedPixel& p, int c) {
             return c == channel ? term(p, c) : 0.0;
           });
  };
  if (name == "mse") return mean_of(pixels, squared);
  if (name == "mse_r") return of_channel(squared, 0);
  if (name == "mse_g") return of_channel(squared, 1);
  if (name == "mse_b") return of_channel(squared, 2);
  if (name == "relmse") return mean_of(pixels, relative);
  if (name == "relmse_r") return of_channel(relative, 0);
  if (name == "relmse_g") return of_channel(relative, 1);
  if (name == "relmse_b") return of_channel(relative, 2);
  if (name == "rmse") {
    return std::sqrt(
        mean_of(pixels, [&](const JudgedPixel& p, int c) { return squared(p, c) + p.b[c]; }));
  }
  if (name == "mae") {
    return mean_of(pixels, [](const JudgedPixel& p, int c) { return std::abs(p.i[c] - p.r[c]); });
  }
  if (name == "relmae") {
    return mean_of(pixels, [&](const JudgedPixel& p, int c) {
      return std::abs(scale * p.i[c] - scale * p.r[c]) / (std::abs(scale * p.r[c]) + 0.01);
    });
  }
  if (name == "smape") {
    return mean_of(pixels, [&](const JudgedPixel& p, int c) {
      return std::abs(scale * p.i[c] - scale * p.r[c]) /
             (std::abs(scale * p.i[c]) + std::abs(scale * p.r[c]) + 0.01);
    });
  }
  if (name == "psnr_tm") {
    long double log_sum = 0, sum = 0;
    for (const JudgedPixel& p : pixels)
      sum += std::max(p.y_r(), 0.0);
    const double mean = static_cast<double>(sum / static_cast<long double>(pixels.size()));
    const double floor = mean < 0.01 ? 0.01 * mean : mean > 100.0 ? 1e-6 * mean : 1e-4;
    for (const JudgedPixel& p : pixels)
      log_sum += std::log(std::max(p.y_r(), 0.0) + floor);
    const double e =
        0.18 / std::exp(static_cast<double>(log_sum / static_cast<long double>(pixels.size())));
    return 10 * std::log10(1 / mean_of(pixels, [&](const JudgedPixel& p, int c) {
                             const double t = tone(p.i[c], e) - tone(p.r[c], e);
                             return t * t;
                           }));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Trimmed mean, dropped share, quantile and maximum; NaN for any other name.
inline double ranked_metric(const std::string& name, const std::vector<JudgedPixel>& pixels,
                            const MetricOptions& o) {
  const double scale = relative_factor(pixels, o);
  std::vector<double> values;
  for (const JudgedPixel& p : pixels) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      sum += name.starts_with("relmse") ? relative_term(p, c, scale, o)
                                        : (p.i[c] - p.r[c]) * (p.i[c] - p.r[c]);
    }
    values.push_back(sum / 3);
  }
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const auto drop = static_cast<std::size_t>(std::ceil(o.trim * static_cast<double>(n) - 1e-9));
  long double kept = 0, dropped = 0;
  for (std::size_t k = 0; k < n; ++k)
    (k < n - drop ? kept : dropped) += values[k];
  if (name == "se_max") return values.back();
  if (name == "se_p999") return values[n - 1 - n / 1000];
  if (name == "relmse_trimmed") return static_cast<double>(kept / (n - drop));
  if (name == "relmse_dropped") return static_cast<double>(dropped / n);
  return std::numeric_limits<double>::quiet_NaN();
}

// Energy of the image (decile 0), or of one decile (1 .. 10) of the denominator's luminance.
inline double energy_metric(int decile, std::vector<JudgedPixel> pixels) {
  std::stable_sort(pixels.begin(), pixels.end(),
                   [](const JudgedPixel& a, const JudgedPixel& b) { return a.y_d() < b.y_d(); });
  long double of_image = 0, of_reference = 0;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    if (decile != 0 && static_cast<int>(k * 10 / pixels.size()) + 1 != decile) continue;
    for (int c = 0; c < 3; ++c) {
      of_image += pixels[k].i[c];
      of_reference += pixels[k].r[c];
    }
  }
  return static_cast<double>(of_image / of_reference);
}

// The pixels with the image of every tenth of them, or of all together, times what gives it the
// reference's energy; as they are where the image has none.
inline std::vector<JudgedPixel> at_equal_energy(std::vector<JudgedPixel> pixels, bool deciles) {
  std::stable_sort(pixels.begin(), pixels.end(),
                   [](const JudgedPixel& a, const JudgedPixel& b) { return a.y_d() < b.y_d(); });
  const auto group = [&](std::size_t k) { return deciles ? k * 10 / pixels.size() : 0; };
  for (std::size_t first = 0, last = 0; first < pixels.size(); first = last) {
    double of_image = 0, of_reference = 0;
    for (last = first; last < pixels.size() && group(last) == group(first); ++last) {
      for (int c = 0; c < 3; ++c) {
        of_image += pixels[last].i[c];
        of_reference += pixels[last].r[c];
      }
    }
    for (std::size_t k = first; k < last && of_image > 0; ++k) {
      for (double& i : pixels[k].i)
        i *= of_reference / of_image;
    }
  }
  return pixels;
}

inline double metric(const std::string& name, const RgbImage& estimate,
                     const JudgingReference& reference, const MetricOptions& o) {
  const std::vector<JudgedPixel> pixels = judged_pixels(estimate, reference);
  if (name == "energy_ratio") return energy_metric(0, pixels);
  if (name.starts_with("energy_ratio_d")) return energy_metric(std::stoi(name.substr(14)), pixels);
  if (name == "relmse_plain") {
    MetricOptions plain = o;
    plain.rel_scale = RelativeScale::kNone;
    return linear_metric("relmse", pixels, plain);
  }
  if (const std::size_t end = name.find("_equal_"); end != std::string::npos) {
    // The scale of relmse is the reference's: it does not change.
    return linear_metric(name.substr(0, end), at_equal_energy(pixels, name.ends_with("deciles")),
                         o);
  }
  const double linear = linear_metric(name, pixels, o);
  return std::isnan(linear) ? ranked_metric(name, pixels, o) : linear;
}

// Mean of (a - r)(b - r) - var r, or of (a - b)^2 / 2, over pixels where everything is finite;
// relative: divided as relmse is.
inline double error_part(bool bias2, bool relative, const RgbImage& a, const RgbImage& b,
                         const JudgingReference& reference, const MetricOptions& o) {
  RgbImage both = a;  // not finite where one of the two is not
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a[c].size(); ++i)
      both[c][i] += 0.0 * b[c][i];
  }
  RgbImage other = b;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a[c].size(); ++i)
      other[c][i] += 0.0 * a[c][i];
  }
  const std::vector<JudgedPixel> first = judged_pixels(both, reference);
  const std::vector<JudgedPixel> second = judged_pixels(other, reference);
  const double scale = relative_factor(first, o);
  long double sum = 0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const JudgedPixel& p = first[k];
      const double ea = p.i[c] - p.r[c], eb = second[k].i[c] - p.r[c];
      double part = bias2 ? ea * eb - p.b[c] : 0.5 * (ea - eb) * (ea - eb);
      if (relative) {
        const double d =
            scale * (o.rel_denominator == RelativeDenominator::kLuminance ? p.y_d() : p.d[c]);
        part *= scale * scale / (d * d + o.rel_eps);
      }
      sum += part;
    }
  }
  return static_cast<double>(sum / 3 / static_cast<long double>(first.size()));
}

// What mse (raw) or relmse stands on: every pixel's error sorted.
inline ErrorSupport error_support(bool relative, const RgbImage& estimate,
                                  const JudgingReference& reference, const MetricOptions& o) {
  const std::vector<JudgedPixel> pixels = judged_pixels(estimate, reference);
  const double scale = relative_factor(pixels, o);
  std::vector<double> errors;
  double all = 0.0, noise = 0.0;
  for (const JudgedPixel& p : pixels) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
      JudgedPixel variance = p;
      variance.i[c] = p.r[c] + std::sqrt(p.b[c]);
      variance.b[c] = 0.0;
      const double raw = (p.i[c] - p.r[c]) * (p.i[c] - p.r[c]);
      sum += (relative ? relative_term(p, c, scale, o) : raw) / 3.0;
      noise += (relative ? relative_term(variance, c, scale, o) : p.b[c]) / 3.0;
    }
    errors.push_back(std::max(0.0, sum));
    all += errors.back();
  }
  std::sort(errors.rbegin(), errors.rend());
  ErrorSupport found{0.0, 0.0, noise / static_cast<double>(pixels.size())};
  const auto worst = static_cast<std::size_t>(std::ceil(static_cast<double>(pixels.size()) / 1e3));
  double borne = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i < worst) found.worst_share += errors[i] / all;
    if (borne < 0.5 * all) found.half_pixels += 1.0;
    borne += errors[i];
  }
  return found;
}

}  // namespace spool::reference
