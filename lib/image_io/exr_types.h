// What all readers and writers of OpenEXR share: types of channels, attributes, limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace spool {

enum class PixelType { kHalf, kFloat, kUint };

constexpr std::size_t bytes_per_value(PixelType type) {
  return type == PixelType::kHalf ? 2 : 4;
}

struct ExrChannel {
  std::string name;
  PixelType type = PixelType::kFloat;

  bool operator==(const ExrChannel&) const = default;
};

struct ExrAttributes {
  std::map<std::string, std::string> texts = {};
  std::map<std::string, double> numbers = {};
};

struct ExrReadLimits {
  std::uint64_t max_pixels = std::uint64_t{1} << 28;
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of all channels, as doubles
  int max_parts = 1;                                 // later ones are not looked at
};

// All without loss. Run lengths take a seventh of the time of zip and half as many bytes again,
// kNone a third of theirs.
enum class ExrCompression { kZip, kRunLengths, kNone };

struct ExrWriteOptions {
  bool overwrite = false;
  bool shared = false;  // several processes may write it: AtomicFile::create
  ExrCompression compression = ExrCompression::kZip;
};

}  // namespace spool
