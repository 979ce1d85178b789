// A number of a block as it is stored, float32 or float16.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "formats/dump_header.h"
#include "formats/half_float.h"

namespace spool::format {

inline float stored_value(std::span<const std::byte> values, DataType type, size_t at) {
  if (type == DataType::kFloat16) {
    uint16_t half = 0;
    std::memcpy(&half, values.data() + 2 * at, 2);
    return half_to_float(half);
  }
  float value = 0;
  std::memcpy(&value, values.data() + 4 * at, 4);
  return value;
}

}  // namespace spool::format
