// The header of a numpy .npy array: magic, version, and a Python dict literal of exactly three
// keys.
//
// Source: numpy.lib.format [NumpyFormat]. The literal is parsed, never evaluated. Errors: kData for
// what numpy may write and this project does not take (objects, big-endian, Fortran order,
// structured types), kDamage for what numpy cannot have written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"

namespace spool::interchange {

struct NpyHeader {
  std::string type;             // numpy's code, little-endian or single bytes: "<f4", "|u1"
  std::vector<uint64_t> shape;  // C order
  uint64_t header_bytes = 0;    // from the magic to the first element

  // Bytes of one element; 0 for a type that has none.
  uint64_t item_bytes() const;
};

// Enough bytes for the header of every array this project takes.
inline constexpr size_t kMaxNpyHeaderBytes = 65536 + 12;

// `start`: the first bytes of the array file. `name` opens the message: "FILE: radiance".
Result<NpyHeader> parse_npy_header(std::span<const std::byte> start, std::string_view name);

// Version 1.0, padded so that the elements start at a multiple of 64.
std::string format_npy_header(std::string_view type, std::span<const uint64_t> shape);

}  // namespace spool::interchange
