// What all readers and writers of OpenEXR share: types of channels, attributes, limits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace spool {

enum class PixelType { kHalf, kFloat, kUint };

constexpr std::size_t bytes_per_value(PixelType type) {
  return type == PixelType::kHalf ? 2 : 4;
}

struct ExrChannel {
  std::string name;
  PixelType type = PixelType::kFloat;
  bool subsampled = false;  // of fewer values than the data window has pixels

  bool operator==(const ExrChannel&) const = default;
};

struct ExrAttributes {
  std::map<std::string, std::string> texts = {};
  std::map<std::string, double> numbers = {};
};

struct ExrPlane {
  std::string name;
  PixelType type = PixelType::kFloat;
  std::vector<std::byte> values = {};  // [y][x], little-endian
};

// Pixels of the plane that the data window and the display window of a file share.
struct ExrWindow {
  std::int64_t x0 = 0, y0 = 0, width = 0, height = 0;

  bool operator==(const ExrWindow&) const = default;
};

// What the header of a part contains.
struct ExrPart {
  std::string name, type;          // empty where the file has none
  std::string view;                // of a part that is one view of several
  std::vector<std::string> views;  // of a part that has several; the first is the default
  std::string lossy;               // the compression, where it changes values
  bool flat = true;
  ExrWindow data, display;
  std::vector<ExrChannel> channels;  // in alphabetical order
  ExrAttributes attributes;
  std::optional<std::array<double, 8>> chromaticities;  // x, y of red, green, blue, white
};

struct ExrReadLimits {
  std::uint64_t max_pixels = std::uint64_t{1} << 28;
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of all channels that are read, as doubles
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
