// Finished cells of an evaluation: lines of DIR/cells/*.jsonl, one file of each process.
//
// A process appends to a file of its own, so several processes or machines may fill one folder, and
// the folders of several may be put together. A line carries its checksum: what a killed run, a
// full disk or a lost machine left of one counts as missing, and is made again. Of several lines of
// one cell the last without a failure counts. Earlier versions wrote a file for each cell,
// cells/ID.json: read, and no longer written.
//
// A cell that has no line of its own is read from DIR/kept.jsonl (kept_lines.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file_handle.h"
#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/experiment/result_record.h"
#include "tools/batch/kept_lines.h"

namespace spool::tools {

class CellStore {
 public:
  // Of what is there; a folder without cells, or none at all ("", too), is empty. kIo when a file
  // of cells cannot be read.
  static Result<CellStore> open(const std::filesystem::path& folder);
  // Whether cells were ever kept in it.
  static bool is_in(const std::filesystem::path& folder);
  static Result<void> create(const std::filesystem::path& folder);
  static Result<void> remove_all(const std::filesystem::path& folder);

  bool empty() const { return entries_.empty(); }
  // Lines whose checksum is wrong; without the last line of a file, which a killed run leaves.
  std::size_t damaged() const { return damaged_; }
  std::string damage() const;  // for a warning, where there is some

  // Found by open() of a later store, not by this one's read().
  Result<void> write(const std::string& id, const ResultRecord& record);
  // What was written is on the disk.
  Result<void> sync();
  // kIo when it is not there, kData when it cannot be understood. The fields that say which cell it
  // is are those of `cell`: a plan may be moved, its recordings too.
  Result<ResultRecord> read(const std::string& id, const Cell& cell) const;
  // How many finished cells there are that `known` does not hold.
  std::size_t count_others(const std::function<bool(const std::string&)>& known) const;
  // Copies cells that are missing here or failed here.
  Result<void> take_from(const CellStore& other);

 private:
  // A line of a file, or a whole file of an earlier version.
  struct Entry {
    std::uint64_t number = 0, offset = 0;
    std::uint32_t bytes = 0, file = 0;
    bool failed = false;
  };

  explicit CellStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Result<void> add_file(const std::filesystem::path& path);
  Result<void> add_old_cell(const std::filesystem::path& path, std::uint64_t number);
  void add_line(std::string_view line, std::uint64_t offset, std::size_t line_number);
  void keep_best();
  const Entry* find(std::uint64_t number) const;
  Result<std::string> text_of(const Entry& entry) const;
  Result<ResultRecord> record_at(const Entry& entry) const;
  Result<void> append(std::string line);

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::optional<format::FileHandle>> open_;  // [file], of the first of them
  std::vector<Entry> entries_;                           // by their numbers, one of each
  std::size_t damaged_ = 0;
  std::string first_damage_;
  KeptLines kept_;

  std::optional<format::FileHandle> own_;  // this process's file, from the first write on
  std::uint64_t own_bytes_ = 0;
  std::chrono::steady_clock::time_point synced_;
};

tl::unexpected<Error> nothing_finished(const std::filesystem::path& folder, const CellStore& store);

}  // namespace spool::tools
