// Little-endian integers to and from bytes, at any alignment.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

namespace spool::format {

static_assert(std::endian::native == std::endian::little,
              "the .spool code reads and writes numbers in memory order");

template <class T>
  requires std::is_trivially_copyable_v<T>
T load(std::span<const std::byte> bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.subspan(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

template <class T>
  requires std::is_trivially_copyable_v<T>
void store(std::span<std::byte> bytes, size_t offset, const T& value) {
  std::memcpy(bytes.subspan(offset, sizeof(T)).data(), &value, sizeof(T));
}

inline bool all_zero(std::span<const std::byte> bytes) {
  for (std::byte b : bytes) {
    if (b != std::byte{0}) return false;
  }
  return true;
}

}  // namespace spool::format
