#include "lib/image_io/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/core/colour.h"
#include "lib/core/image.h"

namespace spool {

std::uint8_t srgb_byte(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb_encoded(std::clamp(linear, 0.0, 1.0))));
}

namespace {

using Linear = std::array<double, 3>;

// The inverse transform of [Ottosson20]: OKLab to linear sRGB.
Linear linear_from_oklab(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const Linear& colour) {
  return std::ranges::all_of(colour, [](double c) { return c >= 0.0 && c <= 1.0; });
}

Linear from_polar(double lightness, double chroma, double hue_deg) {
  const double hue = hue_deg * std::numbers::pi / 180.0;
  return linear_from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
}

// The colour with at most `chroma`, less where sRGB cannot show it.
Linear linear_colour_at(double lightness, double chroma, double hue_deg) {
  double low = 0.0;
  double high = chroma;
  if (!in_gamut(from_polar(lightness, high, hue_deg))) {
    for (int step = 0; step < 20; ++step) {
      const double middle = 0.5 * (low + high);
      (in_gamut(from_polar(lightness, middle, hue_deg)) ? low : high) = middle;
    }
    high = low;
  }
  return from_polar(lightness, high, hue_deg);
}

Rgb8 encoded(const Linear& linear) {
  Rgb8 colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = srgb_byte(linear[c]);
  return colour;
}

Rgb8 colour_at(double lightness, double chroma, double hue_deg) {
  return encoded(linear_colour_at(lightness, chroma, hue_deg));
}

// The colour of this hue whose luminance is `y`: OKLab's own lightness ranks violet too high.
Rgb8 colour_of_luminance(double y, double chroma, double hue_deg) {
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (low + high);
    const Linear linear = linear_colour_at(middle, chroma, hue_deg);
    (luminance(linear[0], linear[1], linear[2]) < y ? low : high) = middle;
  }
  return colour_at(low, chroma, hue_deg);
}

Rgb8 make_sequential_colour(double u) {
  // CIE lightness L* from 8 to 94 carries the value; its cube law is the inverse of L*(Y).
  const double y = std::pow((8.0 + 86.0 * u + 16.0) / 116.0, 3);
  const double chroma = 0.06 + 0.055 * std::sin(std::numbers::pi * u) + 0.06 * u;
  // From violet (305) over teal (205) to yellow (105).
  return colour_of_luminance(y, chroma, 305.0 - 200.0 * u);
}

}  // namespace

Rgb8 sequential_colour(double t) {
  static const auto table = [] {
    std::array<Rgb8, 256> colours{};
    for (std::size_t i = 0; i < 256; ++i) {
      colours[i] = make_sequential_colour(static_cast<double>(i) / 255.0);
    }
    return colours;
  }();
  return table[static_cast<std::size_t>(std::lround(255.0 * std::clamp(t, 0.0, 1.0)))];
}

Rgb8 direction_colour(double angle_deg) {
  return colour_at(0.72, 0.125, 2.0 * angle_deg + 20.0);
}

Rgb8 category_colour(int category) {
  // Hue steps of 3/8 of a turn with alternating lightness keep neighbours far apart.
  const int i = ((category % kCategoryCount) + kCategoryCount) % kCategoryCount;
  return colour_at(i % 2 == 0 ? 0.55 : 0.82, 0.14, 250.0 + 135.0 * i);
}

}  // namespace spool
