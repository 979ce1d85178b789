// The fixed tone map of the perceptual metrics: exposure from the reference alone, then the sRGB
// curve.
#pragma once

#include <cstdint>

#include "lib/core/image.h"

namespace spool {

// 0.18 / exp(mean of ln(max(Y, 0) + log_average_floor)) over the pixels with judged != 0 (of all
// where `judged` is empty): brings the log-average luminance to middle grey.
double tone_map_exposure(const RgbImage& reference, const Image<std::uint8_t>& judged);

// Radiance times `factor`, 0 where not judged so that both images agree there.
RgbImage scaled_judged(const RgbImage& image, double factor, const Image<std::uint8_t>& judged);

// srgb_encoded(clamp(exposure * value, 0, 1)).
double tone_mapped(double value, double exposure);

}  // namespace spool
