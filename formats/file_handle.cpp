#include "formats/file_handle.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

#include "formats/lost_pages.h"

namespace spool::format {

namespace {

// Signals arrive one at a time; a call that was interrupted this often in a row without moving a
// byte will not succeed.
constexpr int kMaxInterruptions = 1000;

int posix_file_size(int fd, uint64_t* bytes, bool* regular) {
  struct stat info{};
  if (::fstat(fd, &info) != 0) return -1;
  *bytes = static_cast<uint64_t>(info.st_size);
  *regular = S_ISREG(info.st_mode);
  return 0;
}

int posix_rename(const char* from, const char* to, bool replace) {
  if (replace) return ::rename(from, to);
  if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  // A file system without RENAME_NOREPLACE: the gap between the two calls is ours to accept.
  struct stat info{};
  if (::lstat(to, &info) == 0) {
    errno = EEXIST;
    return -1;
  }
  return ::rename(from, to);
}

void* posix_map(int fd, size_t bytes) {
  void* data = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
  return data == MAP_FAILED ? nullptr : data;
}

constexpr FileCalls kPosix = {
    .open = [](const char* path, int flags, mode_t mode) { return ::open(path, flags, mode); },
    .close = ::close,
    .file_size = posix_file_size,
    .pread = ::pread,
    .pwrite = ::pwrite,
    .fsync = ::fsync,
    .ftruncate = ::ftruncate,
    .lock = [](int fd) { return ::flock(fd, LOCK_EX | LOCK_NB); },
    .rename = posix_rename,
    .map = posix_map,
    .unmap = [](void* data, size_t bytes) { ::munmap(data, bytes); },
};

std::atomic<const FileCalls*> calls_in_use{&kPosix};

// Repeats `call` while it is interrupted.
template <class Call>
auto uninterrupted(Call call) {
  auto result = call();
  for (int i = 0; result < 0 && errno == EINTR && i < kMaxInterruptions; ++i)
    result = call();
  return result;
}

tl::unexpected<Error> system_error(const std::filesystem::path& path, std::string_view doing,
                                   int cause, std::string_view remedy) {
  return fail(ErrorCode::kIo, "{}: {}: {}: {}", path.string(), doing, std::strerror(cause), remedy);
}

std::string_view open_remedy(int cause) {
  switch (cause) {
    case ENOENT:
      return "check the path";
    case EACCES:
    case EPERM:
    case EROFS:
      return "check the permissions";
    case ENAMETOOLONG:
      return "use a shorter name";
    case ENOSPC:
    case EDQUOT:
      return "free some space";
    case ELOOP:
      return "remove the symbolic link";
    case EMFILE:
    case ENFILE:
      return "close other files or raise the limit (ulimit -n)";
    default:
      return "check the path and the device";
  }
}

bool fits_off_t(uint64_t offset, uint64_t bytes) {
  constexpr auto kMax = static_cast<uint64_t>(std::numeric_limits<off_t>::max());
  return offset <= kMax && bytes <= kMax - offset;
}

}  // namespace

const FileCalls& posix_calls() {
  return kPosix;
}
const FileCalls& file_calls() {
  return *calls_in_use.load(std::memory_order_acquire);
}
void replace_file_calls(const FileCalls& calls) {
  calls_in_use.store(&calls, std::memory_order_release);
}

Result<FileHandle> FileHandle::open(const std::filesystem::path& path, OpenMode mode) {
  int flags = O_CLOEXEC;
  if (mode == OpenMode::kRead) flags |= O_RDONLY | O_NONBLOCK;  // a FIFO must not hang us
  if (mode == OpenMode::kCreate) flags |= O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW;
  if (mode == OpenMode::kAppend) flags |= O_RDWR | O_NOFOLLOW | O_NONBLOCK;
  FileHandle file;
  file.path_ = path;
  file.fd_ = uninterrupted([&] { return file_calls().open(path.c_str(), flags, 0666); });
  if (file.fd_ < 0) {
    const int cause = errno;
    if (cause == EEXIST) {
      return fail(ErrorCode::kUsage, "{}: already exists: remove it or use --force", path.string());
    }
    return system_error(path, mode == OpenMode::kCreate ? "cannot create" : "cannot open", cause,
                        open_remedy(cause));
  }
  return file;
}

FileHandle::FileHandle(FileHandle&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      bytes_read_(other.bytes_read()) {}

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  if (this != &other) {
    if (fd_ >= 0) file_calls().close(fd_);
    fd_ = std::exchange(other.fd_, -1);
    path_ = std::move(other.path_);
    bytes_read_.store(other.bytes_read(), std::memory_order_relaxed);
  }
  return *this;
}

FileHandle::~FileHandle() {
  if (fd_ >= 0) file_calls().close(fd_);
}

Result<uint64_t> FileHandle::size() const {
  uint64_t bytes = 0;
  bool regular = false;
  if (file_calls().file_size(fd_, &bytes, &regular) != 0) {
    return system_error(path_, "cannot read the size", errno, "check the device");
  }
  if (!regular) {
    return fail(ErrorCode::kIo, "{}: is a folder or a device: give a file on disk", path_.string());
  }
  return bytes;
}

Result<void> FileHandle::read_at(uint64_t offset, std::span<std::byte> bytes) const {
  size_t done = 0;
  while (done < bytes.size()) {
    if (!fits_off_t(offset, bytes.size())) {
      return fail(ErrorCode::kDamage, "{}: offset {} is beyond every file: run `spool recover`",
                  path_.string(), offset);
    }
    const auto rest = bytes.subspan(done);
    const ssize_t got = uninterrupted([&] {
      return file_calls().pread(fd_, rest.data(), rest.size(), static_cast<off_t>(offset + done));
    });
    if (got < 0) {
      return system_error(
          path_, fmt::format("cannot read {} bytes at offset {}", rest.size(), offset + done),
          errno, "check the device");
    }
    if (got == 0) {
      return fail(ErrorCode::kDamage,
                  "{}: ends at offset {} while {} more bytes were expected: was it cut meanwhile?",
                  path_.string(), offset + done, rest.size());
    }
    done += static_cast<size_t>(got);
    count_read(static_cast<uint64_t>(got));
  }
  return {};
}

Result<void> FileHandle::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  size_t done = 0;
  while (done < bytes.size()) {
    const auto rest = bytes.subspan(done);
    const ssize_t put = uninterrupted([&] {
      return file_calls().pwrite(fd_, rest.data(), rest.size(), static_cast<off_t>(offset + done));
    });
    if (put <= 0) {
      const int cause = put == 0 ? EIO : errno;
      const bool full = cause == ENOSPC || cause == EDQUOT || cause == EFBIG;
      return system_error(
          path_, fmt::format("cannot write {} bytes at offset {}", rest.size(), offset + done),
          cause, full ? "free some space" : "check the device");
    }
    done += static_cast<size_t>(put);
  }
  return {};
}

Result<void> FileHandle::sync() {
  // Not repeated, not even after EINTR: the kernel may report a lost page only once.
  if (file_calls().fsync(fd_) == 0) return {};
  return system_error(path_, "cannot sync to disk", errno,
                      "treat the file as unwritten, check the device");
}

Result<void> FileHandle::truncate(uint64_t bytes) {
  if (uninterrupted([&] { return file_calls().ftruncate(fd_, static_cast<off_t>(bytes)); }) == 0) {
    return {};
  }
  return system_error(path_, fmt::format("cannot cut to {} bytes", bytes), errno,
                      "check the device");
}

Result<bool> FileHandle::try_lock() {
  if (uninterrupted([&] { return file_calls().lock(fd_); }) == 0) return true;
  if (errno == EWOULDBLOCK) return false;
  return system_error(path_, "cannot lock", errno, "use a file system with flock");
}

Result<bool> FileHandle::hold(const std::filesystem::path& path) {
  const Result<bool> locked = try_lock();
  if (locked && !*locked) return false;
  return is_named(path);
}

Result<void> FileHandle::lock() {
  const Result<bool> locked = try_lock();
  if (!locked || *locked) return {};  // an error: a file system without locks
  return fail(ErrorCode::kIo, "{}: another process is writing it: wait or choose another name",
              path_.string());
}

Result<bool> FileHandle::is_named(const std::filesystem::path& path) const {
  struct stat own{}, named{};
  if (::fstat(fd_, &own) == 0 && ::lstat(path.c_str(), &named) == 0)
    return own.st_dev == named.st_dev && own.st_ino == named.st_ino;
  if (errno == ENOENT) return false;
  return system_error(path, "cannot be looked at", errno, "check the device");
}

Result<void> FileHandle::close() {
  const int fd = std::exchange(fd_, -1);
  // close() is never repeated: the descriptor is gone even when it was interrupted.
  if (fd < 0 || file_calls().close(fd) == 0 || errno == EINTR) return {};
  return system_error(path_, "cannot close", errno, "check the device");
}

Result<FileMapping> FileMapping::create(const FileHandle& file, uint64_t bytes) {
  FileMapping mapping;
  if (bytes <= std::numeric_limits<size_t>::max()) {
    mapping.data_ = file_calls().map(file.fd_, static_cast<size_t>(bytes));
  }
  if (mapping.data_ == nullptr) {
    return system_error(file.path(), fmt::format("cannot map {} bytes", bytes), errno,
                        "read blocks instead of mapping them");
  }
  mapping.bytes_ = static_cast<size_t>(bytes);
  mapping.range_ = watch_range(mapping.data_, mapping.bytes_);
  return mapping;
}

FileMapping::FileMapping(FileMapping&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      range_(std::exchange(other.range_, -1)) {}

FileMapping& FileMapping::operator=(FileMapping&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  std::swap(range_, other.range_);
  return *this;
}

FileMapping::~FileMapping() {
  forget_range(range_);
  if (data_ != nullptr) file_calls().unmap(data_, bytes_);
}

bool FileMapping::lost() const {
  return lost_pages(range_);
}

std::span<const std::byte> FileMapping::bytes() const {
  return {static_cast<const std::byte*>(data_), bytes_};
}

Result<void> refuse_special_file(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::symlink_status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status) ||
      std::filesystem::is_symlink(status)) {
    return {};
  }
  return fail(ErrorCode::kUsage, "{}: is {}: give the name of a file", path.string(),
              std::filesystem::is_directory(status) ? "a folder" : "no regular file");
}

Result<void> rename_file(const std::filesystem::path& from, const std::filesystem::path& to,
                         bool replace) {
  if (file_calls().rename(from.c_str(), to.c_str(), replace) == 0) return {};
  const int cause = errno;
  if (cause == EEXIST) {
    return fail(ErrorCode::kUsage, "{}: already exists: use --force (the data are in {})",
                to.string(), from.string());
  }
  return system_error(to, fmt::format("cannot rename {}", from.filename().string()), cause,
                      "the data are complete under the old name: rename them by hand");
}

Result<void> sync_directory(const std::filesystem::path& directory) {
  const std::filesystem::path folder = directory.empty() ? "." : directory;
  const int fd = uninterrupted(
      [&] { return file_calls().open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0); });
  if (fd < 0) return system_error(folder, "cannot open the folder", errno, "check the permissions");
  const bool synced = file_calls().fsync(fd) == 0;
  const int cause = errno;
  file_calls().close(fd);
  // EINVAL: the file system does not sync folders; its renames are as durable as they get.
  if (synced || cause == EINVAL) return {};
  return system_error(folder, "cannot sync the folder", cause, "check the device");
}

}  // namespace spool::format
