// Files that appear whole or not at all: written under a temporary name, then renamed.
//
// The temporary name is the target's plus ".partial"; it is removed when the writer gives up.
#pragma once

#include <filesystem>
#include <string_view>

#include "lib/core/error.h"

namespace spool {

// An error (kUsage) when `target` exists and `overwrite` is false.
Result<void> refuse_existing(const std::filesystem::path& target, bool overwrite);

// Reserves a temporary name beside `target`. Write to temporary_path(), then commit().
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::filesystem::path& target, bool overwrite);
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temporary_path() const { return temporary_; }
  Result<void> commit();

 private:
  AtomicFile(std::filesystem::path target, std::filesystem::path temporary, bool overwrite);

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty once committed or moved from
  bool overwrite_ = false;
};

Result<void> write_text_file(const std::filesystem::path& target, std::string_view text,
                             bool overwrite);

// Removes what every unfinished AtomicFile of this process has written so far; for the program's
// way out on an interrupt. Any thread may call it. No further file can be begun or committed:
// threads that try wait for the end of the process.
void remove_unfinished_files();

}  // namespace spool
