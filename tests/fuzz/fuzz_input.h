// What the fuzz targets share: the input as a file, and the input as a row of decisions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "tests/formats/made_dump.h"

namespace spool::format {

// A file in memory that each run overwrites. One per process, so that targets can run side by side.
inline const std::filesystem::path& fuzz_file(const char* name) {
  static const ScratchFolder folder;
  static const std::filesystem::path in = folder / "in.spool";
  static const std::filesystem::path out = folder / "out.spool";
  return name[0] == 'i' ? in : out;
}

inline Bytes bytes_of(const uint8_t* data, size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  return {bytes.begin(), bytes.end()};
}

// The law of the target is broken: the fuzzer keeps the input.
inline void demand(bool holds, const char* law) {
  if (holds) return;
  std::fprintf(stderr, "broken law: %s\n", law);
  std::abort();
}

// Reads decisions from the input; all zeros when it is used up.
class Decisions {
 public:
  Decisions(const uint8_t* data, size_t size) : data_(data, size) {}

  bool empty() const { return data_.empty(); }
  uint32_t next() {
    uint32_t value = 0;
    for (int i = 0; i < 4 && !data_.empty(); ++i) {
      value = value << 8 | data_.front();
      data_ = data_.subspan(1);
    }
    return value;
  }
  uint8_t byte() {
    if (data_.empty()) return 0;
    const uint8_t value = data_.front();
    data_ = data_.subspan(1);
    return value;
  }
  uint32_t up_to(uint32_t limit) { return byte() % (limit + 1); }

 private:
  std::span<const uint8_t> data_;
};

}  // namespace spool::format
