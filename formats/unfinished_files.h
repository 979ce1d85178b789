// Files that are worth nothing before they are finished, and what an ending process does with them.
//
// The process has one way out on a signal, so it keeps one list of what to remove there.
#pragma once

#include <filesystem>
#include <functional>

#include "lib/core/error.h"

namespace spool::format {

// Owns the file or folder at `path` until finish(): it is removed when this goes, or when the
// process ends by remove_unfinished_files().
class UnfinishedFile {
 public:
  UnfinishedFile() = default;
  // Calls `make`, which makes the file, and lists it: one step for the code that ends the process.
  static Result<UnfinishedFile> begin(const std::filesystem::path& path,
                                      const std::function<Result<void>()>& make);
  UnfinishedFile(UnfinishedFile&& other) noexcept;
  UnfinishedFile& operator=(UnfinishedFile&& other) noexcept;
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();

  const std::filesystem::path& path() const { return path_; }
  // Calls `rename`, which gives the file its final name; it is not removed afterwards. When
  // `rename` fails, the file stays unfinished.
  Result<void> finish(const std::function<Result<void>()>& rename);

 private:
  explicit UnfinishedFile(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty: nothing to remove
};

// Removes every unfinished file of this process. Any thread may call it; no further file can be
// begun or finished: threads that try wait for the end of the process.
void remove_unfinished_files();

}  // namespace spool::format
