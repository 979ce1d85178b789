// A number of a block as it is stored, float32 or float16.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/byte_io.h"
#include "formats/dump_header.h"
#include "formats/half_float.h"

namespace spool::format {

inline float stored_value(std::span<const std::byte> values, DataType type, size_t at) {
  if (type == DataType::kFloat16) return half_to_float(load<uint16_t>(values, 2 * at));
  return load<float>(values, 4 * at);
}

}  // namespace spool::format
