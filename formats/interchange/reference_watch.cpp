#include "formats/interchange/reference_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "formats/stored_value.h"

namespace spool::interchange {
namespace {

using format::DataType;
using format::PixelRect;
using Light = std::array<double, 3>;

constexpr uint64_t kMostPixels = 16384;
constexpr size_t kLeastPixels = 256;  // fewer may be alike by chance
constexpr double kFits = 0.7;         // of the squared distance that the reference has as it is
constexpr double kSurely = 6.1;       // standard deviations: 1e-9, two-sided
// A reference of few samples is off by less; quarters are chosen by it, and so by its noise, too.
constexpr double kMuch = 1.1, kMuchOfQuarter = 1.5;
constexpr std::array<const char*, 5> kViewTexts = {
    "", "upside down", "mirrored", "turned by 180 degrees", "with x and y exchanged"};

double luminance(const Light& v) {
  return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
}

bool finite(const Light& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

// A few bright values do not decide.
double tone(double value, double scale) {
  return value / (std::abs(value) + scale);
}

Light light_at(std::span<const std::byte> planes, DataType type, size_t at) {
  const size_t plane = planes.size() / 3;
  return {format::stored_value(planes, type, at),
          format::stored_value(planes.subspan(plane), type, at),
          format::stored_value(planes.subspan(2 * plane), type, at)};
}

}  // namespace

ReferenceWatch::ReferenceWatch(uint32_t width, uint32_t height)
    : width_(width), height_(height), views_(width == height ? kViews : kViews - 1) {
  const uint64_t pixels = uint64_t{width} * height;
  stride_ = (pixels + kMostPixels - 1) / kMostPixels;
  while (stride_ > 1 && std::gcd(stride_, uint64_t{width}) > 1)  // pixels of all columns
    ++stride_;
  pixels_.resize((pixels + stride_ - 1) / stride_);
}

void ReferenceWatch::add_radiance(const PixelRect& rect, uint32_t count, DataType type,
                                  std::span<const std::byte> planes) {
  for (uint32_t y = rect.y0; y < rect.y1; ++y) {
    for (uint32_t x = rect.x0; x < rect.x1; ++x) {
      const uint64_t index = uint64_t{y} * width_ + x;
      if (index % stride_ != 0) continue;
      Pixel& pixel = pixels_[index / stride_];
      const size_t at = (size_t{y - rect.y0} * rect.width() + (x - rect.x0)) * count;
      for (uint32_t s = 0; s < count; ++s) {
        const Light sample = light_at(planes, type, at + s);
        if (!finite(sample)) continue;
        for (size_t c = 0; c < 3; ++c)
          pixel.sum[c] += sample[c];
        pixel.squares += luminance(sample) * luminance(sample);
        ++pixel.count;
      }
    }
  }
}

void ReferenceWatch::add_reference(const PixelRect& rect, DataType type,
                                   std::span<const std::byte> planes) {
  for (uint32_t y = rect.y0; y < rect.y1; ++y) {
    for (uint32_t x = rect.x0; x < rect.x1; ++x) {
      const uint32_t left = width_ - 1 - x, up = height_ - 1 - y;
      const std::array<std::array<uint32_t, 2>, kViews> places = {
          {{x, y}, {x, up}, {left, y}, {left, up}, {y, x}}};
      const Light value =
          light_at(planes, type, size_t{y - rect.y0} * rect.width() + (x - rect.x0));
      for (size_t view = 0; view < views_; ++view) {
        const uint64_t index = uint64_t{places[view][1]} * width_ + places[view][0];
        if (index % stride_ != 0) continue;
        pixels_[index / stride_].judges[view] = value;
        pixels_[index / stride_].seen += finite(value);
      }
    }
  }
}

std::vector<const ReferenceWatch::Pixel*> ReferenceWatch::compared() const {
  std::vector<const Pixel*> pixels;
  for (const Pixel& pixel : pixels_) {
    if (pixel.count > 0 && pixel.seen == views_) pixels.push_back(&pixel);
  }
  return pixels;
}

// The views of a reference hold the same values, and so do its channels: noise and a tone curve
// change no distance in favour of one of them.
std::string ReferenceWatch::turned(std::span<const Pixel* const> pixels) const {
  double scale = 0;
  for (const Pixel* pixel : pixels)
    scale += std::abs(luminance(pixel->judges[0])) / static_cast<double>(pixels.size());
  if (!(scale > 0)) return "";
  std::array<std::array<double, 2>, kViews> distances{};  // [view][red and blue exchanged]
  for (const Pixel* pixel : pixels) {
    for (size_t c = 0; c < 3; ++c) {
      const double mean = tone(pixel->sum[c] / static_cast<double>(pixel->count), scale);
      for (size_t view = 0; view < views_; ++view) {
        distances[view][0] += std::pow(mean - tone(pixel->judges[view][c], scale), 2);
        distances[view][1] += std::pow(mean - tone(pixel->judges[view][2 - c], scale), 2);
      }
    }
  }
  size_t best = 0, exchanged = 0;
  for (size_t view = 0; view < views_; ++view) {
    for (const size_t other : {size_t{0}, size_t{1}}) {
      if (distances[view][other] < distances[best][exchanged]) best = view, exchanged = other;
    }
  }
  if (!(distances[best][exchanged] < kFits * distances[0][0])) return "";
  const char* both = best > 0 && exchanged > 0 ? " and " : "";
  return fmt::format("reference: fits the samples {}{}{}: save both alike", kViewTexts[best], both,
                     exchanged > 0 ? "with red and blue exchanged" : "");
}

// How much light the reference has, as a multiple of that of the samples; 1 where they differ by
// less than `much` or than the noise of the samples may be.
double ReferenceWatch::light_ratio(std::span<const Pixel* const> pixels, double much) {
  double samples = 0, reference = 0, variance = 0;
  for (const Pixel* pixel : pixels) {
    if (pixel->count < 2) continue;  // whose noise is not known
    const auto n = static_cast<double>(pixel->count);
    const double sum = luminance(pixel->sum);
    samples += sum / n;
    reference += luminance(pixel->judges[0]);
    variance += std::abs(pixel->squares - sum * sum / n) / (n - 1) / n;
  }
  const bool noise = std::abs(reference - samples) < kSurely * std::sqrt(variance);
  if (noise || !(samples > 0) || !(reference >= 0)) return 1;
  const double ratio = reference / samples;
  return ratio > much || ratio < 1 / much ? ratio : 1;
}

// All of it, then by the brightness in the reference, as a tone curve shows.
std::string ReferenceWatch::other_light(std::vector<const Pixel*> pixels) {
  constexpr const char* kText =
      "reference: has {:.2g} times the light of the samples{}, beyond their noise: save the "
      "same picture in their units, linear, with nothing clamped";
  if (const double ratio = light_ratio(pixels, kMuch); ratio != 1)
    return fmt::format(kText, ratio, "");
  std::stable_sort(pixels.begin(), pixels.end(), [](const Pixel* a, const Pixel* b) {
    return luminance(a->judges[0]) < luminance(b->judges[0]);
  });
  const size_t quarter = pixels.size() / 4;
  const auto all = std::span<const Pixel* const>(pixels);
  if (const double ratio = light_ratio(all.last(quarter), kMuchOfQuarter); ratio != 1)
    return fmt::format(kText, ratio, " in the brightest quarter");
  // Few samples may be black by chance, and these pixels are chosen by it.
  if (const double ratio = light_ratio(all.first(quarter), kMuchOfQuarter); ratio != 1 && ratio > 0)
    return fmt::format(kText, ratio, " in the darkest quarter");
  return "";
}

std::string ReferenceWatch::remark() const {
  const std::vector<const Pixel*> pixels = compared();
  if (pixels.size() < kLeastPixels) return "";
  std::string found = turned(pixels);
  return found.empty() ? other_light(pixels) : found;
}

}  // namespace spool::interchange
