// Several files that belong together, and appear together: written into a hidden folder beside
// their targets, .NAME.spool-RANDOM.partial, then renamed one after another.
//
// What stood under their names goes into that folder before the first of them appears: whenever the
// process is killed, files of two sets never stand beside each other.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/target_watch.h"
#include "formats/unfinished_files.h"
#include "lib/core/error.h"

namespace spool::format {

class FileSet {
 public:
  // `names`: of all files of the set in `folder`, in the order in which they are to appear, and
  // after them those of an earlier set, which go. kUsage where one is there and `force` is not set,
  // is no file, or is one of `inputs`.
  static Result<FileSet> create(const std::filesystem::path& folder, std::vector<std::string> names,
                                bool force, const std::vector<std::filesystem::path>& inputs);

  // Calls `write` with the place of one of the files before it appears; an error names the target.
  Result<void> write(const std::string& name,
                     const std::function<Result<void>(const std::filesystem::path&)>& write);

  // Whole or not at all, unless the process is killed. kIo when another process wrote one of them.
  Result<void> publish();

 private:
  Result<void> exchange(bool& undone);

  std::filesystem::path folder_;
  std::vector<std::string> names_;
  std::vector<std::optional<FileIdentity>> found_;  // under the names, when this was begun
  UnfinishedFile hidden_;
};

}  // namespace spool::format
