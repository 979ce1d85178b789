// OpenEXR files bit for bit: channels in their own type, every part, and deep scanlines.
//
// exr_image.h is the comfortable door for pictures; this one is for exchange, where a NaN keeps its
// payload and a half stays a half. Files are taken as hostile: sizes are checked against the cap
// and against the length of the file before anything is allocated. Errors as in exr_image.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_image.h"

namespace spool {

constexpr std::size_t bytes_per_value(PixelType type) {
  return type == PixelType::kHalf ? 2 : 4;
}

struct ExrPlane {
  std::string name;
  PixelType type = PixelType::kFloat;
  std::vector<std::byte> values = {};  // [y][x], little-endian
};

struct ExrAttributes {
  std::map<std::string, std::string> texts = {};
  std::map<std::string, double> numbers = {};
};

struct ExrPlanes {
  int width = 0;
  int height = 0;
  int x0 = 0, y0 = 0;  // of the data window
  std::vector<ExrPlane> planes = {};
  ExrAttributes attributes = {};
  bool rec709 = true;  // no chromaticities, or those of Rec. 709
};

// The first limits.max_parts parts. Where a later part is named and its channels are not, "PART."
// is put before them, as readers of several parts do. Parts of another size are refused (kData).
Result<ExrPlanes> read_exr_planes(const std::filesystem::path& path,
                                  const ExrReadLimits& limits = {});

// One part, ZIP-compressed scanlines; written under a temporary name, then renamed.
Result<void> write_exr_planes(const std::filesystem::path& path, const ExrPlanes& image,
                              const ExrWriteOptions& options = {});

struct DeepChannel {
  std::string name;
  PixelType type = PixelType::kFloat;

  bool operator==(const DeepChannel&) const = default;
};

struct DeepHeader {
  int width = 0;
  int height = 0;
  std::vector<DeepChannel> channels;  // in alphabetical order when read
  ExrAttributes attributes = {};
};

struct DeepReadLimits {
  std::uint64_t max_pixels = std::uint64_t{1} << 28;
  std::uint64_t max_row_bytes = std::uint64_t{1} << 30;  // of all channels of a scanline
};

// One scanline of a deep image. values[channel]: the samples of pixel 0, then of pixel 1, ...
struct DeepRow {
  std::vector<std::uint32_t> counts;  // [x]
  std::vector<std::vector<std::byte>> values;
};

// The first part of a deep scanline file, row by row in bounded memory.
class DeepExrReader {
 public:
  static Result<DeepExrReader> open(const std::filesystem::path& path,
                                    const DeepReadLimits& limits = {});
  DeepExrReader(DeepExrReader&&) noexcept;
  DeepExrReader& operator=(DeepExrReader&&) noexcept;
  ~DeepExrReader();

  const DeepHeader& header() const;
  // kDamage when the row is missing, does not decode or claims more than the file can hold.
  Result<DeepRow> read_row(int y);

 private:
  struct State;
  explicit DeepExrReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Deep scanlines with the same number of samples in every pixel; ZIPS.
class DeepExrWriter {
 public:
  static Result<DeepExrWriter> create(const std::filesystem::path& path, const DeepHeader& header,
                                      std::uint32_t samples, bool overwrite);
  DeepExrWriter(DeepExrWriter&&) noexcept;
  DeepExrWriter& operator=(DeepExrWriter&&) = delete;
  ~DeepExrWriter();

  // Rows in order; values[channel]: [x][sample], in the order of the header.
  Result<void> write_row(const std::vector<std::vector<std::byte>>& values);
  // After the last row: the file gets its name.
  Result<void> finish();

 private:
  struct State;
  explicit DeepExrWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Whether part 0 is deep; false when it cannot be read.
bool is_deep_exr(const std::filesystem::path& path);

}  // namespace spool
