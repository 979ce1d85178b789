// Planes behind what is said of them, for a page: a number of four bytes, lowest first, and so many
// bytes of JSON that say width, height and planes; then the planes as 32-bit floats [y][x][c].
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/core/image.h"

namespace spool::tools {

class PlaneText {
 public:
  PlaneText(int width, int height)
      : said_({{"width", width}, {"height", height}, {"planes", nlohmann::ordered_json::array()}}) {
  }

  void say(const std::string& name, const nlohmann::ordered_json& value) { said_[name] = value; }
  void add(const std::string& name, const RgbImage& image) {
    add(name, 3, image[0].size(), [&](std::size_t c, std::size_t p) { return image[c][p]; });
  }
  template <class T>
  void add(const std::string& name, const Image<T>& image) {
    add(name, 1, image.size(), [&](std::size_t, std::size_t p) { return image[p]; });
  }
  std::string text() const;

 private:
  // value(channel, pixel)
  template <class Value>
  void add(const std::string& name, std::size_t channels, std::size_t pixels, Value&& value) {
    said_["planes"].push_back({{"name", name}, {"channels", channels}});
    for (std::size_t p = 0; p < pixels; ++p) {
      for (std::size_t c = 0; c < channels; ++c)
        values_.push_back(static_cast<float>(value(c, p)));
    }
  }

  nlohmann::ordered_json said_;
  std::vector<float> values_;
};

}  // namespace spool::tools
