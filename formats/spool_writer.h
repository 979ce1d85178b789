// Writes a .spool file by appending records.
//
// The file is NAME.partial until finish() has written index and footer, synced it and renamed it to
// NAME. A writer that is destroyed without finish() leaves NAME.partial, from which every whole
// record can be recovered. Blocks may come in any order. One thread per writer.
//
// Errors: kUsage for a call that breaks the contract (target exists, wrong payload size, block
// written twice); kIo when the system refuses or another process writes the same file. After a kIo
// error the file is cut back to its last whole record and the writer accepts nothing more; a failed
// fsync is never repeated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "formats/dump_header.h"
#include "lib/core/error.h"

namespace spool::format {

struct WriterOptions {
  bool compress = false;  // byte shuffle + zstd, kept per block only where it saves 5 % or more
  bool force = false;     // replace an existing NAME and a stale NAME.partial
  std::optional<std::array<uint8_t, 16>> uuid = {};  // for reproducible files; random when absent
  uint64_t sync_every_bytes = uint64_t{256} << 20;   // at most this a power failure costs, or 30 s
  // What can be made again at any time: NAME.partial goes with a writer that did not finish, and
  // with a process that is interrupted (formats/unfinished_files.h).
  bool discard_unfinished = false;
};

class SpoolWriter {
 public:
  static Result<SpoolWriter> create(const std::filesystem::path& path, const DumpHeader& header,
                                    const WriterOptions& options = {});

  // Goes on with NAME.partial: verifies it, cuts off a torn end and continues with the same uuid.
  // `options.uuid` is not used. has_block() returns what is there already. kDamage when intact
  // records stand behind a damaged one: resuming would drop them, recovery keeps them.
  static Result<SpoolWriter> resume(const std::filesystem::path& path,
                                    const WriterOptions& options = {});

  SpoolWriter(SpoolWriter&&) noexcept;
  SpoolWriter& operator=(SpoolWriter&&) noexcept;
  ~SpoolWriter();

  const DumpHeader& header() const;

  uint32_t meta_count() const;

  // One JSON object; later records override top-level keys of earlier ones.
  Result<void> write_meta(std::string_view json);

  // payload: dtype[channel][y][x][sample] of all channels of the group, cropped to the image.
  // Group of scope sample: sample_begin a multiple of block_spp, sample_count the whole block;
  // pixel: 0 and 1, one value per pixel; pass: tile 0, dtype[channel][1][1][sample].
  Result<void> write_block(uint16_t group, uint32_t tile, uint32_t sample_begin,
                           uint32_t sample_count, std::span<const std::byte> payload);

  bool has_block(uint16_t group, uint32_t tile, uint32_t block) const;

  Result<void> finish();

 private:
  struct State;
  explicit SpoolWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spool::format
