#include "lib/image_io/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace spool {
namespace {

// The process has one way out on an interrupt, so it keeps one list of what to clean up there.
struct Unfinished {
  std::mutex mutex;
  std::set<std::string> paths;
};

Unfinished& unfinished() {
  static Unfinished instance;
  return instance;
}

void forget(const std::filesystem::path& path) {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().paths.erase(path.string());
}

}  // namespace

Result<void> refuse_existing(const std::filesystem::path& target, bool overwrite) {
  std::error_code status;
  if (!overwrite && std::filesystem::exists(std::filesystem::symlink_status(target, status))) {
    return fail(ErrorCode::kUsage, "{}: exists already: choose another name or give --force",
                target.string());
  }
  return {};
}

AtomicFile::AtomicFile(std::filesystem::path target, std::filesystem::path temporary,
                       bool overwrite)
    : target_(std::move(target)), temporary_(std::move(temporary)), overwrite_(overwrite) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      overwrite_(other.overwrite_) {}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget(temporary_);
}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& target, bool overwrite) {
  SPOOL_TRY(refuse_existing(target, overwrite));
  std::error_code status;
  if (std::filesystem::is_directory(target, status)) {
    return fail(ErrorCode::kUsage, "{}: is a folder: give the name of a file", target.string());
  }
  // The process id keeps two runs with the same target apart.
  std::filesystem::path temporary = target;
  temporary += fmt::format(".{}.partial", ::getpid());
  // Made and listed as one step: an interrupt sees both or neither.
  const std::scoped_lock lock(unfinished().mutex);
  const int descriptor = ::open(temporary.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): check that the folder exists",
                target.string(), std::strerror(errno));
  }
  ::close(descriptor);
  unfinished().paths.insert(temporary.string());
  return AtomicFile(target, std::move(temporary), overwrite);
}

Result<void> AtomicFile::commit() {
  SPOOL_TRY(refuse_existing(target_, overwrite_));
  const int descriptor = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int sync_error = errno;
  if (descriptor >= 0) ::close(descriptor);
  const std::scoped_lock lock(unfinished().mutex);
  if (!synced || ::rename(temporary_.c_str(), target_.c_str()) != 0) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): nothing was changed", target_.string(),
                std::strerror(synced ? errno : sync_error));
  }
  unfinished().paths.erase(temporary_.string());
  temporary_.clear();
  return {};
}

Result<void> write_text_file(const std::filesystem::path& target, std::string_view text,
                             bool overwrite) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(target, overwrite));
  const int descriptor = ::open(file.temporary_path().c_str(), O_WRONLY | O_CLOEXEC);
  std::size_t written = 0;
  while (descriptor >= 0 && written < text.size()) {
    const ssize_t n = ::write(descriptor, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    written += static_cast<std::size_t>(n);
  }
  const int write_error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (descriptor < 0 || written < text.size()) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): nothing was changed", target.string(),
                std::strerror(write_error));
  }
  return file.commit();
}

void remove_unfinished_files() {
  unfinished().mutex.lock();  // for good: no thread begins another file
  for (const std::string& path : unfinished().paths)
    ::unlink(path.c_str());
}

}  // namespace spool
