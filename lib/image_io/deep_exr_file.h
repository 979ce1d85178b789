// Deep scanlines of OpenEXR, bit for bit and row by row in bounded memory.
//
// Files are taken as hostile, as in exr_planes.h. Errors as in exr_image.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool {

struct DeepHeader {
  int width = 0;
  int height = 0;
  std::vector<ExrChannel> channels;  // in alphabetical order when read
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

}  // namespace spool
