#include "lib/image_io/picture.h"

#include <algorithm>
#include <cmath>

#include "lib/core/log_average.h"

namespace spool {

Picture::Picture(int w, int h, Rgb8 fill_colour) : width(w), height(h) {
  rgb.resize(std::size_t{3} * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  fill(*this, 0, 0, w, h, fill_colour);
}

void Picture::set(int x, int y, Rgb8 colour) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x));
  std::ranges::copy(colour, rgb.begin() + static_cast<std::ptrdiff_t>(i));
}

Rgb8 Picture::at(int x, int y) const {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x));
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

double tone_exposure(const RgbImage& reference) {
  double sum = 0.0, logarithms = 0.0, n = 0.0;
  const auto for_finite = [&](auto&& use) {
    for (std::size_t i = 0; i < reference[0].size(); ++i) {
      const double y = luminance(reference[0][i], reference[1][i], reference[2][i]);
      if (std::isfinite(y)) use(std::max(y, 0.0));
    }
  };
  for_finite([&](double y) { sum += y, n += 1.0; });
  const double floor = log_average_floor(sum / n);
  for_finite([&](double y) { logarithms += std::log(y + floor); });
  return n == 0.0 ? 1.0 : 0.18 / std::exp(logarithms / n);
}

Picture tone_map(const RgbImage& image, double exposure) {
  Picture picture(image[0].width(), image[0].height());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      Rgb8 colour{};
      bool finite = true;
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = image[c](x, y);
        finite = finite && std::isfinite(value);
        if (finite) colour[c] = srgb_byte(exposure * value);
      }
      picture.set(x, y, finite ? colour : kNotFinite);
    }
  }
  return picture;
}

ValueRange common_range(std::span<const Plane* const> planes, bool log) {
  double low = INFINITY;
  double high = -INFINITY;
  double smallest_positive = INFINITY;
  for (const Plane* plane : planes) {
    for (const double value : plane->pixels()) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
      if (value > 0.0) smallest_positive = std::min(smallest_positive, value);
    }
  }
  if (!(high >= low)) return {0.0, 1.0, false};
  if (!log || high <= 0.0) return {low, high, false};
  return {std::max(smallest_positive, high * 1e-6), high, true};
}

double position_in_range(double value, const ValueRange& range) {
  const bool usable = range.high > range.low && (!range.log || range.low > 0.0);
  if (!usable) return value > range.low ? 1.0 : 0.0;
  if (!range.log) return std::clamp((value - range.low) / (range.high - range.low), 0.0, 1.0);
  if (value <= range.low) return 0.0;
  return std::clamp(std::log(value / range.low) / std::log(range.high / range.low), 0.0, 1.0);
}

namespace {

template <class ColourOf>
Picture map_pixels(const Plane& plane, ColourOf&& colour_of) {
  Picture picture(plane.width(), plane.height());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x)
      picture.set(x, y, colour_of(plane(x, y)));
  }
  return picture;
}

}  // namespace

Picture false_colour(const Plane& plane, const ValueRange& range) {
  return map_pixels(plane, [&](double value) {
    return std::isfinite(value) ? sequential_colour(position_in_range(value, range)) : kNotFinite;
  });
}

Picture direction_picture(const Plane& angle_deg) {
  return map_pixels(angle_deg, [](double angle) {
    return std::isfinite(angle) ? direction_colour(angle) : kNeutral;
  });
}

Picture category_picture(const Plane& category) {
  return map_pixels(category, [](double value) {
    // Beyond 1e6 no whole number is meant; the cast below must stay defined.
    return value >= 0.0 && value < 1e6 ? category_colour(static_cast<int>(value)) : kNeutral;
  });
}

Picture enlarge(const Picture& picture, int factor) {
  Picture larger(picture.width * factor, picture.height * factor);
  for (int y = 0; y < larger.height; ++y) {
    for (int x = 0; x < larger.width; ++x)
      larger.set(x, y, picture.at(x / factor, y / factor));
  }
  return larger;
}

void paste(Picture& target, const Picture& source, int left, int top) {
  for (int y = std::max(0, -top); y < std::min(source.height, target.height - top); ++y) {
    for (int x = std::max(0, -left); x < std::min(source.width, target.width - left); ++x) {
      target.set(left + x, top + y, source.at(x, y));
    }
  }
}

void fill(Picture& target, int left, int top, int width, int height, Rgb8 colour) {
  for (int y = std::max(0, top); y < std::min(target.height, top + height); ++y) {
    for (int x = std::max(0, left); x < std::min(target.width, left + width); ++x) {
      target.set(x, y, colour);
    }
  }
}

}  // namespace spool
