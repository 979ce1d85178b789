// Features in another convention, recognised by the range of their values: normals stored as
// n / 2 + 1 / 2, reflectances above 1, distances below 0 or of a depth buffer, light of 8 bits,
// film positions outside the pixel.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_header.h"

namespace spool::interchange {

class FeatureRanges {
 public:
  explicit FeatureRanges(uint64_t pixels);

  // Planes [component][pixel][sample] of a part of a layer, float32 or float16.
  void add(const std::string& layer, size_t components, size_t pixels, size_t samples,
           format::DataType type, std::span<const std::byte> planes);

  // One sentence for each layer that is not as formats/spool.md 10 has it.
  std::vector<std::string> remarks() const;

 private:
  struct Range {  // of the finite values of a layer
    size_t components = 0;
    uint64_t vectors = 0;                          // that are not zero, and are finite
    uint64_t unit = 0, encoded = 0, encoded8 = 0;  // of them: |v|, |2 v - 1|, |2 v / 255 - 1| is 1
    uint64_t forward = 0, backward = 0;            // of them: Z above, below 0
    uint64_t left = 0, right = 0;                  // of them: X below, above 0
    uint64_t values = 0, above = 0, below = 0, far = 0;  // above 1, below 0; of no hit in the scene
    std::array<double, 3> least{}, most{};               // of what is neither 0 nor far
    double shortest = 0, longest = 0;
    std::array<uint64_t, 256> levels{}, levels255{};  // of light: k, and k / 255
  };

  static void add_light(Range& range, std::span<const double> v, format::DataType type);
  void add_vector(Range& range, std::span<const double> v);
  static std::string of_direction(const std::string& layer, const Range& range);
  static std::string of_light(const std::string& layer, const Range& range);
  static std::string of_reflectance(const std::string& layer, const Range& range);
  static std::string of_film(const Range& range);
  std::string of_distance(const std::string& layer, const Range& range) const;

  size_t stride_ = 1;
  std::map<std::string, Range> ranges_;
};

}  // namespace spool::interchange
