// A reference that is another picture than the samples: turned, with its channels in another order,
// or with another amount of light. Noticed in up to 16384 pixels, evenly spread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_header.h"

namespace spool::interchange {

class ReferenceWatch {
 public:
  ReferenceWatch(uint32_t width, uint32_t height);

  // Samples of the pixels of `rect`: three planes [y][x][s] of float32 or float16.
  void add_radiance(const format::PixelRect& rect, uint32_t count, format::DataType type,
                    std::span<const std::byte> planes);
  // The reference of these pixels: three planes [y][x].
  void add_reference(const format::PixelRect& rect, format::DataType type,
                     std::span<const std::byte> planes);

  // One sentence; empty: nothing was found, or there is no reference.
  std::string remark() const;

 private:
  using Light = std::array<double, 3>;
  static constexpr size_t kViews = 5;  // as it is, upside down, mirrored, both, transposed

  struct Pixel {
    Light sum{};                         // of its finite samples
    double squares = 0;                  // of their luminance
    uint64_t count = 0;                  // of them
    std::array<Light, kViews> judges{};  // what the reference holds there, seen so
    uint32_t seen = 0;                   // in how many views it is finite
  };

  std::vector<const Pixel*> compared() const;
  std::string turned(std::span<const Pixel* const> pixels) const;
  static double light_ratio(std::span<const Pixel* const> pixels, double much);
  static std::string other_light(std::vector<const Pixel*> pixels);

  uint32_t width_, height_;
  uint64_t stride_;
  size_t views_;  // the last one of a square alone
  std::vector<Pixel> pixels_;
};

}  // namespace spool::interchange
