// Colours for numbers: a sequential map, a hue wheel and a set of categories.
//
// Hues and chroma are those of OKLab [Ottosson20], in which equal steps look equal. The sequential
// map rises linearly in CIE lightness from dark violet over teal to pale yellow, so it also reads
// in grey; the wheel has constant lightness, so no direction looks stronger than another.
#pragma once

#include <array>
#include <cstdint>

namespace spool {

using Rgb8 = std::array<std::uint8_t, 3>;  // sRGB, encoded

// A linear value as sRGB encodes it; clamped to [0, 1].
std::uint8_t srgb_byte(double linear);

// t in [0,1], clamped.
Rgb8 sequential_colour(double t);

// Period 180 degrees: a direction and its opposite are the same.
Rgb8 direction_colour(double angle_deg);

// Well separated colours; repeats after kCategoryCount.
inline constexpr int kCategoryCount = 8;
Rgb8 category_colour(int category);

inline constexpr Rgb8 kBlack = {0, 0, 0};
inline constexpr Rgb8 kWhite = {255, 255, 255};
inline constexpr Rgb8 kNeutral = {110, 110, 110};  // "no direction", "no value"
inline constexpr Rgb8 kNotFinite = {255, 0, 200};  // a colour no map contains

}  // namespace spool
