// Files that appear whole or not at all: written under a name of their own beside the target, then
// renamed.
//
// The name is TARGET.spool-RANDOM.partial, made with O_EXCL: processes of one id (containers,
// machines of one network folder) do not meet in it. The file is locked (flock) while its writer
// lives, which separates what a killed process left from what another one still writes.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "formats/file_handle.h"
#include "formats/target_watch.h"
#include "formats/unfinished_files.h"
#include "lib/core/error.h"

namespace spool::format {

// Eight, for a name that no other process gives.
std::string random_letters();

// TARGET.spool-RANDOM.partial, shortened to what a file system takes, with a letter to spare.
std::filesystem::path temporary_name(const std::filesystem::path& target);

// The error of a file `name`, or of a temporary one beside it, as one of `target`, which the user
// knows.
tl::unexpected<Error> named_after(const std::filesystem::path& target,
                                  const std::filesystem::path& name, Error error);

// What may stand in the target's place when the file is finished.
enum class Replace {
  kNothing,      // the target must not be there
  kWhatWasHere,  // the file that stood there when this one was begun, or nothing
  kAnything,     // several processes write the same: the last one stays
};

class TemporaryFile {
 public:
  static Result<TemporaryFile> create(const std::filesystem::path& target);

  const std::filesystem::path& path() const { return unfinished_.path(); }
  FileHandle& file() { return file_; }

  // Syncs and renames. kIo when the target is no longer what `replace` allows (another process was
  // faster: its file stays, this one goes), or when the system refuses.
  Result<void> publish(Replace replace);

 private:
  std::filesystem::path target_;
  std::optional<FileIdentity> found_;  // the target when this was begun
  FileHandle file_;
  UnfinishedFile unfinished_;  // after file_: removed while the lock is still held
};

// A file without a name beside the target: where importers and exporters lay out what does not fit
// memory. It is gone when it is closed, even if the process is killed.
Result<FileHandle> open_scratch_file(const std::filesystem::path& out);

// Removes the temporary files in `folder` whose writers are gone: those without a lock and
// unchanged for `age`. Where locks do not work, none. Returns how many.
std::size_t sweep_temporary_files(const std::filesystem::path& folder,
                                  std::chrono::seconds age = std::chrono::seconds(0));

}  // namespace spool::format
