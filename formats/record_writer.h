// Appends records to NAME.partial and turns it into NAME: the file side of every writer.
//
// Knows sequence numbers, offsets, index and footer, and nothing of geometry. After a failed call
// nothing more is accepted; a torn record is cut off first where the system still allows it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "formats/file_handle.h"
#include "formats/structures.h"
#include "formats/unfinished_files.h"
#include "lib/core/error.h"

namespace spool::format {

// "NAME.partial". What can be made again is "NAME.remade.partial": what a killed process left there
// is replaced unasked, which a NAME.partial, perhaps of a recording, never is.
std::filesystem::path partial_name(const std::filesystem::path& path, bool remade = false);

class RecordWriter {
 public:
  RecordWriter() = default;
  // A new NAME.partial that holds the file header. `force`: a stale NAME.partial is replaced, and
  // publish() replaces an existing NAME. A file that could not even be started is removed.
  // `discard`: so is one that is not published, also when the process is interrupted, and what a
  // killed one left under this name is replaced. kIo when another process is writing it.
  static Result<RecordWriter> create(const std::filesystem::path& path, const FileHeader& header,
                                     bool force, bool discard);
  // Takes over an open, locked NAME.partial after its last good record and cuts off the rest.
  static Result<RecordWriter> resume(const std::filesystem::path& path, FileHandle file,
                                     const FileHeader& header, std::vector<IndexEntry> entries,
                                     uint64_t end, bool force);

  // Sequence, recording id, stored_bytes and CRC of `record` are set here.
  Result<void> append(RecordHeader record, std::span<const std::byte> stored);
  // A record without codec and without a place in the image.
  Result<void> append_plain(std::string_view type, std::span<const std::byte> payload);

  // INDX, footer, fsync: NAME.partial is then a complete file. publish() gives it its name.
  Result<void> seal(uint64_t data_records, uint32_t flags);
  Result<void> publish();

  // How much a power failure may cost (256 MiB); besides, every 30 s are synced.
  void sync_every(uint64_t bytes) { sync_every_ = bytes; }

  const FileHeader& file_header() const { return header_; }
  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& partial() const { return partial_; }

 private:
  Result<void> check_running() const;
  Result<void> stop_after(Error error);
  Result<void> sync();
  void build(RecordHeader& record, std::span<const std::byte> stored);

  std::filesystem::path path_, partial_;
  FileHandle file_;
  UnfinishedFile discarded_;  // partial_, or nothing; goes before file_ gives up the lock
  FileHeader header_;
  std::vector<IndexEntry> entries_;
  std::vector<std::byte> buffer_;
  uint64_t end_ = 0;  // of the last whole record
  uint64_t synced_until_ = 0;
  uint64_t sync_every_ = uint64_t{256} << 20;
  std::chrono::steady_clock::time_point synced_at_ = std::chrono::steady_clock::now();
  bool force_ = false;
  bool stopped_ = false;
};

}  // namespace spool::format
