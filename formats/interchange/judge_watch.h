// A reference and its variance with which no verb opens the recording (lib/pool/reference_check.h).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_header.h"
#include "lib/core/error.h"

namespace spool::interchange {

class JudgeWatch {
 public:
  JudgeWatch(uint32_t width, uint32_t height) : width_(width), pixels_(size_t{width} * height) {}

  // Three planes [y][x] of the pixels of `rect`.
  void add_reference(const format::PixelRect& rect, format::DataType type,
                     std::span<const std::byte> planes) {
    note(rect, type, planes, judges_);
  }
  void add_variance(const format::PixelRect& rect, format::DataType type,
                    std::span<const std::byte> planes) {
    note(rect, type, planes, varies_);
  }

  // kData where no value of the reference is finite, or its variance is not where it is.
  Result<void> judge(const std::string& source) const;

 private:
  using Finite = std::vector<bool>;  // [c][y][x]; empty where there is no such layer

  void note(const format::PixelRect& rect, format::DataType type, std::span<const std::byte> planes,
            Finite& finite) const;

  size_t width_, pixels_;
  Finite judges_, varies_;
};

}  // namespace spool::interchange
