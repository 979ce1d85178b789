// Counter-based random numbers: a value is a pure function of the words that name it.
//
// mix(seed, a, b, ...) folds its words one at a time by xor and passes each through the finaliser
// of splitmix64 [SteeleLeaFlood14]. No generator state exists, so nothing depends on the order of
// calls or on threads.
#pragma once

#include <bit>
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
//
// A Feistel network on the next power of two, walked until it lands inside. Halves of up to 4 bits
// (n <= 256) take a whole table of round outputs from one word, so their round functions are
// uniformly random; the number of rounds is what it takes for all pairs of places to be equally
// likely (a test counts them; with 4 rounds some pairs are off by a third).
inline constexpr std::uint32_t permute_index(std::uint32_t i, std::uint32_t n, std::uint64_t key) {
  const auto bits = static_cast<unsigned>(std::bit_width(n - 1));
  const unsigned left_bits = bits / 2, right_bits = bits - left_bits;
  const std::uint32_t left_mask = (1u << left_bits) - 1, right_mask = (1u << right_bits) - 1;
  const std::uint64_t rounds = bits <= 3 ? 16 : 10;
  const auto round_output = [&](std::uint64_t round, std::uint32_t half) {
    return static_cast<std::uint32_t>(right_bits <= 4 ? splitmix64(key + round) >> (4 * half)
                                                      : splitmix64(key ^ (half | (round << 40))));
  };
  std::uint32_t x = i;
  do {
    std::uint32_t left = x >> right_bits, right = x & right_mask;
    for (std::uint64_t round = 0; round < rounds; round += 2) {
      left ^= round_output(round, right) & left_mask;
      right ^= round_output(round + 1, left) & right_mask;
    }
    x = (left << right_bits) | right;
  } while (x >= n);
  return x;
}

}  // namespace spool
