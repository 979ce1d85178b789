// What stands under a name that is about to be given to another file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "lib/core/error.h"

namespace spool::format {

// A file that was replaced or written has another one.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t seconds = 0, nanoseconds = 0;

  bool operator==(const FileIdentity&) const = default;
};
// Nothing where no file is.
std::optional<FileIdentity> identity_of(const std::filesystem::path& path);

// Held, the check of a target and the rename onto it are one step for all that use this. Where
// folders cannot be locked the gap between the two stays.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

// kUsage when `out` exists and `force` is not set: asked before hours of unpacking.
Result<void> refuse_existing_target(const std::filesystem::path& out, bool force);

// kUsage when `out` is the file `input`, by whatever name: what it is made of would be gone.
Result<void> refuse_own_input(const std::filesystem::path& out, const std::filesystem::path& input);

// kIo: the file under that name is another than when this process began.
tl::unexpected<Error> written_meanwhile(const std::filesystem::path& target);

}  // namespace spool::format
