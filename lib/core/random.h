// Counter-based random numbers: a value is a pure function of the words that name it.
//
// mix(seed, a, b, ...) folds its words one at a time by xor and passes each through the finaliser
// of splitmix64 [SteeleLeaFlood14]. No generator state exists, so nothing depends on the order of
// calls or on threads.
#pragma once

#include <cstdint>

namespace spool {

inline constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

template <class... Words>
constexpr std::uint64_t mix(std::uint64_t seed, Words... words) {
  std::uint64_t state = splitmix64(seed);
  ((state = splitmix64(state ^ static_cast<std::uint64_t>(words))), ...);
  return state;
}

// Uniform in [0, 1) with 53 bits.
inline constexpr double unit_double(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

// Index 0..n-1 that `key` sends `i` to: a permutation of [0, n) for every key (n >= 1).
// A four-round Feistel network on the next even power of two, walked until it lands inside.
inline constexpr std::uint32_t permute_index(std::uint32_t i, std::uint32_t n, std::uint64_t key) {
  unsigned half_bits = 1;
  while ((std::uint64_t{1} << (2 * half_bits)) < n)
    ++half_bits;
  const std::uint32_t half_mask = (std::uint32_t{1} << half_bits) - 1;
  std::uint32_t x = i;
  do {
    std::uint32_t left = x >> half_bits, right = x & half_mask;
    for (std::uint64_t round = 0; round < 4; ++round) {
      const auto f =
          static_cast<std::uint32_t>(splitmix64(key ^ (right | (round << 40)))) & half_mask;
      const std::uint32_t next = left ^ f;
      left = right;
      right = next;
    }
    x = (left << half_bits) | right;
  } while (x >= n);
  return x;
}

}  // namespace spool
