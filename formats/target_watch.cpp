#include "formats/target_watch.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

namespace spool::format {
namespace {

namespace fs = std::filesystem;

constexpr int kFolderTries = 200;  // of 5 ms: a rename takes microseconds

}  // namespace

std::optional<FileIdentity> identity_of(const fs::path& path) {
  struct stat info{};
  if (::lstat(path.c_str(), &info) != 0) return std::nullopt;
  return FileIdentity{info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size),
                      info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(
          ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  for (int i = 0; descriptor_ >= 0 && i < kFolderTries; ++i) {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> refuse_existing_target(const fs::path& out, bool force) {
  std::error_code ignored;
  // A link to nothing is there, too.
  if (force || !fs::exists(fs::symlink_status(out, ignored))) return {};
  return fail(ErrorCode::kUsage, "{}: exists: choose another name or use --force", out.string());
}

Result<void> refuse_own_input(const fs::path& out, const fs::path& input) {
  std::error_code ignored;
  if (!fs::equivalent(out, input, ignored)) return {};
  return fail(ErrorCode::kUsage, "{}: output is the input: choose another name", out.string());
}

tl::unexpected<Error> written_meanwhile(const fs::path& target) {
  return fail(ErrorCode::kIo,
              "{}: another process wrote it meanwhile: that file stays, this one was dropped",
              target.string());
}

}  // namespace spool::format
