#include "lib/metrics/error_parts.h"

#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/metrics/bootstrap.h"

namespace spool {
namespace {

bool judged(const RgbImage& a, const RgbImage& b, const JudgingReference& reference,
            std::size_t p) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += a[c][p] + b[c][p] + reference.mean[c][p];
    if (reference.variance) sum += (*reference.variance)[c][p];
    if (reference.denominator) sum += (*reference.denominator)[c][p];
  }
  return std::isfinite(sum);
}

// 1 / (D^2 + rel_eps) after the relative scale, for squared errors before it.
double relative_weight(const RgbImage& denominator, std::size_t c, std::size_t p, double scale,
                       const MetricOptions& options) {
  const double d = scale * (options.rel_denominator == RelativeDenominator::kLuminance
                                ? luminance(denominator[0][p], denominator[1][p], denominator[2][p])
                                : denominator[c][p]);
  return scale * scale / (d * d + options.rel_eps);
}

}  // namespace

ErrorParts error_parts(const RgbImage& a, const RgbImage& b, const JudgingReference& reference,
                       double relative_scale, const MetricOptions& options) {
  const RgbImage& divisor = reference.denominator ? *reference.denominator : reference.mean;
  const std::size_t pixels = a[0].size();
  const auto mean = [&](bool relative, auto&& part) {
    const double sum = pairwise_sum(pixels, [&](std::size_t p) {
      double of_pixel = 0.0;
      if (!judged(a, b, reference, p)) return of_pixel;
      for (std::size_t c = 0; c < 3; ++c) {
        of_pixel += part(c, p) / 3.0 *
                    (relative ? relative_weight(divisor, c, p, relative_scale, options) : 1.0);
      }
      return of_pixel;
    });
    const double count =
        pairwise_sum(pixels, [&](std::size_t p) { return judged(a, b, reference, p) ? 1.0 : 0.0; });
    return quotient(sum, count);
  };
  const auto bias2 = [&](std::size_t c, std::size_t p) {
    const double r = reference.mean[c][p];
    const double of_reference = reference.variance ? (*reference.variance)[c][p] : 0.0;
    return (a[c][p] - r) * (b[c][p] - r) - of_reference;
  };
  const auto variance = [&](std::size_t c, std::size_t p) {
    const double difference = a[c][p] - b[c][p];
    return 0.5 * difference * difference;
  };
  ErrorParts parts{mean(false, bias2), mean(false, variance), mean(true, bias2),
                   mean(true, variance), 0};
  for (std::size_t p = 0; p < pixels; ++p)
    parts.pixels += judged(a, b, reference, p) ? 1 : 0;
  return parts;
}

}  // namespace spool
