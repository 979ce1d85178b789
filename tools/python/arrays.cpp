#include "tools/python/arrays.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "formats/record_layout.h"

namespace spool::python {
namespace {

// numpy owns the values from now on.
template <class T>
nb::object owned(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* data = held->data();
  const nb::capsule owner(held.release(),
                          [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(data, shape, owner));
}

}  // namespace

nb::object plane_to_numpy(const Plane& plane) {
  const auto pixels = plane.pixels();
  return owned(std::vector<double>(pixels.begin(), pixels.end()),
               {static_cast<std::size_t>(plane.height()), static_cast<std::size_t>(plane.width())});
}

nb::object counts_to_numpy(const CountImage& counts) {
  const auto pixels = counts.pixels();
  return owned(
      std::vector<std::int32_t>(pixels.begin(), pixels.end()),
      {static_cast<std::size_t>(counts.height()), static_cast<std::size_t>(counts.width())});
}

nb::object rgb_to_numpy(const RgbImage& image) {
  std::vector<double> values(3 * image[0].size());
  for (std::size_t i = 0; i < image[0].size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      values[3 * i + c] = image[c][i];
  }
  return owned(std::move(values), {static_cast<std::size_t>(image[0].height()),
                                   static_cast<std::size_t>(image[0].width()), 3});
}

Plane plane_from_numpy(const PlaneArray& array) {
  Plane plane(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  std::copy_n(array.data(), plane.size(), plane.pixels().begin());
  return plane;
}

Result<void> check_image_size(std::size_t width, std::size_t height, const std::string& name) {
  if (width > 0 && height > 0 && width <= format::kMaxSide && height <= format::kMaxSide &&
      width * height <= format::kMaxPixels) {
    return {};
  }
  return fail(ErrorCode::kUsage,
              "{}: {} x {} pixels: give 1 to {} on a side, and at most {} in all", name, width,
              height, format::kMaxSide, format::kMaxPixels);
}

RgbImage rgb_from_numpy(const ImageArray& array) {
  RgbImage image = make_rgb(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  for (std::size_t i = 0; i < image[0].size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      image[c][i] = array.data()[3 * i + c];
  }
  return image;
}

Result<CountImage> counts_from_numpy(const CountArray& array, const std::string& name) {
  CountImage counts(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  for (int y = 0; y < counts.height(); ++y) {
    for (int x = 0; x < counts.width(); ++x) {
      const std::int64_t count = array.data()[counts.index(x, y)];
      if (count < 0 || count > std::numeric_limits<std::int32_t>::max()) {
        return fail(ErrorCode::kData, "{}: {} is no number of samples (pixel {}, {})", name, count,
                    x, y);
      }
      counts(x, y) = static_cast<std::int32_t>(count);
    }
  }
  return counts;
}

}  // namespace spool::python
