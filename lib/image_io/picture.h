// Pictures of images: 8-bit sRGB pixels made from radiance, counts, sizes and angles.
//
// Nothing here is measured from: pictures are for eyes, numbers come from the planes themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/image.h"
#include "lib/image_io/colour_map.h"

namespace spool {

struct Picture {
  Picture() = default;
  Picture(int w, int h, Rgb8 fill = kBlack);

  void set(int x, int y, Rgb8 colour);
  Rgb8 at(int x, int y) const;

  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // [y][x][c]
};

// 0.18 / exp(mean ln(max(Y,0) + log_average_floor)) over the finite pixels: the mean of the
// logarithm of luminance becomes middle grey. Take it from the reference and use it for all
// pictures of a scene.
double tone_exposure(const RgbImage& reference);

// sRGB_encode(clamp(exposure * value, 0, 1)); non-finite pixels are kNotFinite.
Picture tone_map(const RgbImage& image, double exposure);

// What the ends of the sequential map stand for.
struct ValueRange {
  double low = 0.0;
  double high = 1.0;
  bool log = false;
};

// Smallest and largest finite value of all planes, for a scale they share. A logarithmic range
// starts at the smallest positive value, but not below high / 1e6.
ValueRange common_range(std::span<const Plane* const> planes, bool log);

double position_in_range(double value, const ValueRange& range);

Picture false_colour(const Plane& plane, const ValueRange& range);

// Angles in degrees, modulo 180; NaN means "none" and is kNeutral.
Picture direction_picture(const Plane& angle_deg);

// Each value is one category; NaN and negative are kNeutral.
Picture category_picture(const Plane& category);

// Whole-number enlargement by repeating pixels, so that single pixels stay visible.
Picture enlarge(const Picture& picture, int factor);

void paste(Picture& target, const Picture& source, int left, int top);
void fill(Picture& target, int left, int top, int width, int height, Rgb8 colour);

}  // namespace spool
