// With which weights a filter made single pixels: kept only on request, like views.
//
//   image(pixel) = sum over taps of weight value,  sum of weights = 1
//
// A tap is a pixel whose samples took part; its value is the mean of those that the filter averaged
// there, before any filter: empty pieces filled, clamped samples clamped. Weights are those of this
// run: the sizes, directions and likenesses that the filter decided on are held fixed.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "lib/core/image.h"

namespace spool {

struct FootprintTap {
  double weight = 0.0;
  std::array<double, 3> weighted = {};  // weight times value, radiance units
};

// What an anisotropic filter decided for one piece of the pixel.
struct FootprintShape {
  int size = 1;                                   // pieces across; 1: the base image
  double direction = 0.0;                         // degrees mod 180 of the widest extent, or NaN
  std::vector<std::pair<double, double>> widths;  // beta in degrees, delta in pieces
};

struct Footprint {
  int x = 0, y = 0;                                  // the pixel
  std::map<std::pair<int, int>, FootprintTap> taps;  // by (y, x) of their pixels
  std::vector<FootprintShape> shapes;                // of the pixel's pieces; may be empty

  void add(int tap_x, int tap_y, double weight, const RgbImage& values, std::size_t at,
           double scale = 1.0) {
    FootprintTap& tap = taps[{tap_y, tap_x}];
    tap.weight += weight;
    for (std::size_t c = 0; c < 3; ++c)
      tap.weighted[c] += weight * scale * values[c][at];
  }
};

// Collects the footprints of the pixels asked for. A filter that cannot say adds none.
class Footprints {
 public:
  explicit Footprints(std::vector<std::pair<int, int>> wanted) : wanted_(std::move(wanted)) {}

  const std::vector<std::pair<int, int>>& wanted() const { return wanted_; }  // (x, y)
  void add(Footprint footprint) { told_.push_back(std::move(footprint)); }
  const std::vector<Footprint>& told() const { return told_; }  // in the order of `wanted`, or none

  // The mean of these and of another filter run's, as its image is the mean of both images.
  void average_with(const Footprints& other) {
    if (told_.size() != other.told_.size()) told_.clear();
    for (std::size_t i = 0; i < told_.size(); ++i) {
      for (auto& [place, tap] : told_[i].taps)
        halve(tap);
      for (const auto& [place, tap] : other.told_[i].taps) {
        FootprintTap half = tap;
        halve(half);
        FootprintTap& sum = told_[i].taps[place];
        sum.weight += half.weight;
        for (std::size_t c = 0; c < 3; ++c)
          sum.weighted[c] += half.weighted[c];
      }
      told_[i].shapes.insert(told_[i].shapes.end(), other.told_[i].shapes.begin(),
                             other.told_[i].shapes.end());
    }
  }

 private:
  static void halve(FootprintTap& tap) {
    tap.weight *= 0.5;
    for (double& v : tap.weighted)
      v *= 0.5;
  }

  std::vector<std::pair<int, int>> wanted_;
  std::vector<Footprint> told_;
};

}  // namespace spool
