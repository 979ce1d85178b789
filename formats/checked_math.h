// The only place where sizes of a file are multiplied, added and rounded.
//
// Every function returns nullopt instead of wrapping round. Sizes are uint64_t throughout.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>

namespace spool::format {

constexpr std::optional<uint64_t> checked_multiply(uint64_t a, uint64_t b) {
  if (a != 0 && b > UINT64_MAX / a) return std::nullopt;
  return a * b;
}

constexpr std::optional<uint64_t> checked_add(uint64_t a, uint64_t b) {
  if (b > UINT64_MAX - a) return std::nullopt;
  return a + b;
}

constexpr std::optional<uint64_t> checked_product(std::initializer_list<uint64_t> factors) {
  std::optional<uint64_t> product = 1;
  for (uint64_t factor : factors) {
    if (product) product = checked_multiply(*product, factor);
  }
  return product;
}

constexpr std::optional<uint64_t> checked_sum(std::initializer_list<uint64_t> terms) {
  std::optional<uint64_t> sum = 0;
  for (uint64_t term : terms) {
    if (sum) sum = checked_add(*sum, term);
  }
  return sum;
}

// True when `size` bytes starting at `position` lie inside [0, end).
constexpr bool fits(uint64_t position, uint64_t size, uint64_t end) {
  return position <= end && size <= end - position;
}

// n rounded up to a multiple of 64.
constexpr std::optional<uint64_t> checked_pad64(uint64_t n) {
  if (n > UINT64_MAX - 63) return std::nullopt;
  return (n + 63) & ~uint64_t{63};
}

// ceil(a / b) for b > 0.
constexpr uint64_t divide_up(uint64_t a, uint64_t b) {
  return a / b + (a % b != 0 ? 1 : 0);
}

}  // namespace spool::format
