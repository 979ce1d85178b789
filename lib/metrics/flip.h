// FLIP: the difference seen when flipping between two images, per pixel in [0, 1]
// [AnderssonEtAl20], and its extension to high dynamic range [AnderssonEtAl21].
//
// Written from the papers, in double, with the authors' constants for a monitor of 3840 pixels in
// 0.7 m at 0.7 m; its tests compare with the authors' program. Borders are clamped. Negative values
// count as 0 in HDR-FLIP; the authors' tone map takes them as they are.
#pragma once

#include <cstdint>
#include <optional>

#include "lib/core/image.h"

namespace spool {

inline constexpr double kFlipPixelsPerDegree = 67.02064327658225;  // 3840 pi / 180

// What one image looks like: its colours after the eye's filter, and the size of its features.
struct FlipView {
  RgbImage lab;
  Plane edge, point;
};
// Of linear RGB; values outside [0, 1] are clamped.
FlipView flip_view(const RgbImage& image);
Plane flip_difference(const FlipView& reference, const FlipView& test);

// The same of two images.
Plane flip_ldr_map(const RgbImage& reference, const RgbImage& test);

// An ordinary picture needs 5 to 15, one for each stop between its median and its brightest pixel.
// Beyond this number they are spread evenly over the same range.
inline constexpr int kMostFlipExposures = 16;

struct FlipExposures {
  double start = 0, stop = 0;  // base-2 logarithms
  int count = 0;
};
// Exposures at which HDR-FLIP looks, from the brightest and the median luminance of the reference's
// pixels that are judged (all of them without a mask); absent when none of them has a positive one.
std::optional<FlipExposures> flip_exposures(const RgbImage& reference,
                                            const Image<std::uint8_t>& judged = {});

// The largest LDR-FLIP over the exposures, tone-mapped by the ACES fit. Absent as above.
std::optional<Plane> flip_hdr_map(const RgbImage& reference, const RgbImage& test,
                                  const Image<std::uint8_t>& judged = {});

}  // namespace spool
