// Files that appear whole or not at all: written under a temporary name, then renamed
// (formats/temporary_file.h); the temporary file is removed when the writer gives up.
#pragma once

#include <filesystem>
#include <string_view>

#include "formats/temporary_file.h"
#include "lib/core/error.h"

namespace spool {

// An error (kUsage) when `target` exists and `overwrite` is false.
Result<void> refuse_existing(const std::filesystem::path& target, bool overwrite);

// Reserves a temporary name beside `target`. Write to file() or temporary_path(), then commit().
class AtomicFile {
 public:
  // `shared`: several processes may write the target at the same time, the last one stays.
  // Otherwise the one that is slower gets kIo from commit() and changes nothing.
  static Result<AtomicFile> create(const std::filesystem::path& target, bool overwrite,
                                   bool shared = false);

  const std::filesystem::path& temporary_path() const { return file_.path(); }
  format::FileHandle& file() { return file_.file(); }  // the same, open for writing
  Result<void> commit();

 private:
  AtomicFile(format::TemporaryFile file, format::Replace replace);

  format::TemporaryFile file_;
  format::Replace replace_ = format::Replace::kNothing;
};

Result<void> write_text_file(const std::filesystem::path& target, std::string_view text,
                             bool overwrite, bool shared = false);

}  // namespace spool
