// Four pixels side by side in registers of 32 bytes, which sixteen of hold what a loop over samples
// needs; of 64 bytes the machines without such registers would spill half.
#pragma once

#include <cstddef>
#include <cstring>

namespace spool {

inline constexpr int kLanes = 4;

// Vectors of the compiler: what the machine has no register for is cut into what it has.
using FourFloats = float __attribute__((vector_size(kLanes * sizeof(float))));
using FourDoubles = double __attribute__((vector_size(kLanes * sizeof(double))));

// to[k][l] = sample k of pixel l, four of each; `pixel` floats from one pixel to the next.
[[gnu::always_inline]] inline void transpose_four(const float* from, std::ptrdiff_t pixel,
                                                  FourFloats* to) {
  FourFloats rows[kLanes], pairs[kLanes];
  for (int l = 0; l < kLanes; ++l)
    std::memcpy(&rows[l], from + l * pixel, sizeof(FourFloats));
  for (int l = 0; l < kLanes; l += 2) {
    pairs[l] = __builtin_shufflevector(rows[l], rows[l + 1], 0, 4, 2, 6);
    pairs[l + 1] = __builtin_shufflevector(rows[l], rows[l + 1], 1, 5, 3, 7);
  }
  for (int l = 0; l < 2; ++l) {
    to[l] = __builtin_shufflevector(pairs[l], pairs[l + 2], 0, 1, 4, 5);
    to[l + 2] = __builtin_shufflevector(pairs[l], pairs[l + 2], 2, 3, 6, 7);
  }
}

}  // namespace spool
