#include "lib/metrics/tone_map.h"

#include <algorithm>
#include <cmath>

#include "lib/core/colour.h"
#include "lib/core/log_average.h"
#include "lib/core/pairwise_sum.h"

namespace spool {

double tone_map_exposure(const RgbImage& reference, const Image<std::uint8_t>& judged) {
  const std::size_t size = reference[0].size();
  const auto counts = [&](std::size_t p) { return judged.empty() || judged[p] != 0; };
  const double n = pairwise_sum(size, [&](std::size_t p) { return counts(p) ? 1.0 : 0.0; });
  if (n == 0.0) return 1.0;
  const auto judged_luminance = [&](std::size_t p) {
    return std::max(luminance(reference[0][p], reference[1][p], reference[2][p]), 0.0);
  };
  const double floor = log_average_floor(
      pairwise_sum(size, [&](std::size_t p) { return counts(p) ? judged_luminance(p) / n : 0.0; }));
  const double sum = pairwise_sum(
      size, [&](std::size_t p) { return counts(p) ? std::log(judged_luminance(p) + floor) : 0.0; });
  return 0.18 / std::exp(sum / n);
}

RgbImage scaled_judged(const RgbImage& image, double factor, const Image<std::uint8_t>& judged) {
  RgbImage result = make_rgb(judged.width(), judged.height());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < judged.size(); ++p) {
      if (judged[p]) result[c][p] = factor * image[c][p];
    }
  }
  return result;
}

double tone_mapped(double value, double exposure) {
  return srgb_encoded(std::clamp(exposure * value, 0.0, 1.0));
}

}  // namespace spool
