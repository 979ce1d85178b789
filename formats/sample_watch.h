// Are the samples of a pixel in no meaningful order, as a recording may claim? Noticed while they
// are written, in one pass and bounded memory: images that come again, running means, a trend,
// pixels that stop being sampled.
//
// Up to 16384 pixels are watched, evenly spread. An image is kept as the sums of its tone-mapped
// luminance under 16 random signs a pixel: the squares of their differences estimate the squared
// distance of two images without bias, at any lag.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_header.h"

namespace spool::format {

class SampleWatch {
 public:
  // `shared_places`: all pixels of an image share one film position.
  SampleWatch(uint32_t width, uint32_t height, uint32_t spp, bool shared_places = false);

  // Samples [begin, begin + count) of the pixels of `rect`: three planes [y][x][s] of float32 or
  // float16. A pixel's samples come in ascending order.
  void add(const PixelRect& rect, uint32_t begin, uint32_t count, DataType type,
           std::span<const std::byte> planes);

  // What samples in no meaningful order do not do, worded for a message; empty: nothing was found.
  std::string objection() const;

 private:
  static constexpr size_t kSums = 16;
  // Two images are alike where their root mean square difference is this small, two samples of a
  // pixel where theirs is ten times that: then at most 1 % of the pixels of alike images differ.
  static constexpr double kSame = 1e-6, kClose = 1e-3;
  static constexpr float kSamePixel = 1e-5F, kClosePixel = 1e-2F;

  struct Course {  // of one pixel
    float last = 0;
    uint32_t same = 0, close = 0;  // samples like the one before, by the two tolerances
    uint32_t head = 0, run = 0;    // equal ones at the beginning (0: all so far), and at the end
    bool equal_between = false;
    float first = 0, second = 0;         // values
    uint32_t forward = 0, backward = 0;  // how often the second follows the first, and the reverse
  };

  template <class Each>
  void each_pixel(const PixelRect& rect, uint32_t count, DataType type,
                  std::span<const std::byte> planes, Each each);
  void follow(Course& course, uint32_t begin, std::span<const float> values);
  bool evident(uint32_t Course::* alike) const;
  bool one_value(uint32_t image) const;
  double distance(uint32_t a, uint32_t b) const;
  std::string repeated() const;
  std::string running_mean() const;
  std::string trend() const;
  std::string moving_mean() const;
  std::string stopped() const;
  std::string begun_again() const;

  uint32_t width_ = 0, spp_ = 0, stride_ = 1;
  bool shared_places_ = false;
  float scale_ = 0;  // a mean luminance, of the first block that is not black
  std::vector<Course> courses_;
  std::vector<std::array<double, kSums>> sums_;  // of each image
  std::vector<double> light_;                    // sum of each image
  std::vector<float> least_, most_;              // of each image
};

}  // namespace spool::format
