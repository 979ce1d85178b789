// Marks a loop that the compiler shall translate once for each vector width; the machine picks one
// when the program starts.
//
// Wider vectors do not change a bit: every element gets the same operations in the same order, and
// without contraction (-ffp-contract=off) there is no fused multiply-add to differ by. So only
// loops whose iterations are independent may be marked. tests/determinism holds the clones to that.
// Vectors wider than the plain target's go between functions by pointer, never by value: clones and
// other functions hand them over in different places, which shows only where nothing is inlined
// (-Werror=psabi refuses it). Not with sanitizers, which start after the machine has picked;
// SPOOL_NO_VECTOR_CLONES leaves the plain loop.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(SPOOL_NO_VECTOR_CLONES)
#define SPOOL_HAS_VECTOR_CLONES
#define SPOOL_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define SPOOL_VECTOR_CLONES
#endif
