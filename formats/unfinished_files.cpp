#include "formats/unfinished_files.h"

#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace spool::format {
namespace {

struct Listed {
  std::mutex mutex;
  std::set<std::string> paths;
};

Listed& listed() {
  static Listed instance;
  return instance;
}

}  // namespace

Result<UnfinishedFile> UnfinishedFile::begin(const std::filesystem::path& path,
                                             const std::function<Result<void>()>& make) {
  const std::scoped_lock lock(listed().mutex);
  SPOOL_TRY(make());
  listed().paths.insert(path.string());
  return UnfinishedFile(path);
}

UnfinishedFile::UnfinishedFile(UnfinishedFile&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

UnfinishedFile& UnfinishedFile::operator=(UnfinishedFile&& other) noexcept {
  std::swap(path_, other.path_);
  return *this;
}

UnfinishedFile::~UnfinishedFile() {
  if (path_.empty()) return;
  const std::scoped_lock lock(listed().mutex);
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  listed().paths.erase(path_.string());
}

Result<void> UnfinishedFile::finish(const std::function<Result<void>()>& rename) {
  const std::scoped_lock lock(listed().mutex);
  SPOOL_TRY(rename());
  listed().paths.erase(path_.string());
  path_.clear();
  return {};
}

void remove_unfinished_files() {
  listed().mutex.lock();  // for good: no thread begins or finishes another file
  std::error_code ignored;
  for (const std::string& path : listed().paths)
    std::filesystem::remove_all(path, ignored);
}

}  // namespace spool::format
