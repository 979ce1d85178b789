// Eight floats that are one register of AVX2. g++ keeps wider vectors in memory on such a machine,
// where each operation then loads and stores; of narrower ones it wastes half of a register.
// Sixteen are a register of AVX-512. SPOOL_VECTOR_WIDTHS translates a function once for each of
// them: what `call` names as Vector is the widest that the machine holds in a register.
//
// Loaded and stored by std::memcpy, handed on by pointer (lib/core/vector_clones.h).
#pragma once

#include "lib/core/vector_clones.h"

namespace spool {

inline constexpr int kEight = 8;
typedef float Eight __attribute__((vector_size(kEight * sizeof(float))));
typedef float Sixteen __attribute__((vector_size(2 * kEight * sizeof(float))));

template <class Vector>
inline constexpr int kFloats = static_cast<int>(sizeof(Vector) / sizeof(float));

#define SPOOL_FOR_WIDTH(Width, signature, call) \
  signature {                                   \
    using Vector = Width;                       \
    call;                                       \
  }
#ifdef SPOOL_HAS_VECTOR_CLONES
#define SPOOL_VECTOR_WIDTHS(signature, call)                                          \
  __attribute__((target("arch=x86-64-v4"))) SPOOL_FOR_WIDTH(Sixteen, signature, call) \
      __attribute__((target("avx2"))) SPOOL_FOR_WIDTH(Eight, signature, call)         \
          __attribute__((target("default"))) SPOOL_FOR_WIDTH(Eight, signature, call)
#else
#define SPOOL_VECTOR_WIDTHS(signature, call) SPOOL_FOR_WIDTH(Eight, signature, call)
#endif

}  // namespace spool
