// Eight floats that are one register of AVX2. g++ keeps wider vectors in memory on such a machine,
// where each operation then loads and stores; of narrower ones it wastes half of a register.
//
// Loaded and stored by std::memcpy, handed on by pointer (lib/core/vector_clones.h).
#pragma once

namespace spool {

inline constexpr int kEight = 8;
typedef float Eight __attribute__((vector_size(kEight * sizeof(float))));

}  // namespace spool
