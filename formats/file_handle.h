// The one seam over the POSIX file calls, and an owned file descriptor.
//
// Everything in formats/ that touches a file goes through FileCalls, so that tests can fail,
// shorten or interrupt any call. Reads and writes are positional. EINTR is retried a bounded number
// of times, short transfers continue, every other error (EAGAIN too) is reported once with its
// cause.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "lib/core/error.h"

namespace spool::format {

// The calls, with the meaning and errno of their POSIX namesakes. rename: `replace` false fails
// with EEXIST when the target exists.
struct FileCalls {
  int (*open)(const char* path, int flags, mode_t mode);
  int (*close)(int fd);
  int (*file_size)(int fd, uint64_t* bytes, bool* regular);
  ssize_t (*pread)(int fd, void* data, size_t bytes, off_t offset);
  ssize_t (*pwrite)(int fd, const void* data, size_t bytes, off_t offset);
  int (*fsync)(int fd);
  int (*ftruncate)(int fd, off_t bytes);
  int (*lock)(int fd);  // flock(LOCK_EX | LOCK_NB)
  int (*rename)(const char* from, const char* to, bool replace);
  void* (*map)(int fd, size_t bytes);  // read-only, shared; nullptr on failure
  void (*unmap)(void* data, size_t bytes);
};

const FileCalls& posix_calls();

// The calls in use: posix_calls() unless a test has put others in place.
const FileCalls& file_calls();
// For tests, while no file is open. The table must outlive its use.
void replace_file_calls(const FileCalls& calls);

enum class OpenMode {
  kRead,
  kCreate,  // must not exist
  kAppend,  // must exist; for reading and writing
};

class FileHandle {
 public:
  FileHandle() = default;
  static Result<FileHandle> open(const std::filesystem::path& path, OpenMode mode);

  FileHandle(FileHandle&& other) noexcept;
  FileHandle& operator=(FileHandle&& other) noexcept;
  ~FileHandle();

  const std::filesystem::path& path() const { return path_; }
  uint64_t bytes_read() const { return bytes_read_.load(std::memory_order_relaxed); }
  void count_read(uint64_t bytes) const { bytes_read_.fetch_add(bytes, std::memory_order_relaxed); }

  // kIo unless a regular file.
  Result<uint64_t> size() const;
  // Fills `bytes`; kDamage when the file ends before.
  Result<void> read_at(uint64_t offset, std::span<std::byte> bytes) const;
  Result<void> write_at(uint64_t offset, std::span<const std::byte> bytes);
  Result<void> sync();
  Result<void> truncate(uint64_t bytes);
  // Locks the file; whether it is this process's and still called `path`. Where the file system has
  // no locks (NFS, some of FUSE), O_EXCL alone keeps a second writer out.
  Result<bool> hold(const std::filesystem::path& path);
  // False when another process holds the lock; kIo where the file system has none.
  Result<bool> try_lock();
  // kIo when another process holds the lock; where the file system has none, nothing is done.
  Result<void> lock();
  // Whether `path` still leads to this file: it may have been renamed, replaced or removed.
  Result<bool> is_named(const std::filesystem::path& path) const;
  Result<void> close();

 private:
  friend class FileMapping;
  int fd_ = -1;
  std::filesystem::path path_;
  mutable std::atomic<uint64_t> bytes_read_{0};
};

// A whole file mapped for reading, and watched by formats/lost_pages.h.
class FileMapping {
 public:
  FileMapping() = default;
  static Result<FileMapping> create(const FileHandle& file, uint64_t bytes);

  FileMapping(FileMapping&& other) noexcept;
  FileMapping& operator=(FileMapping&& other) noexcept;
  ~FileMapping();

  std::span<const std::byte> bytes() const;
  // Pages were lost and read as zeros.
  bool lost() const;

 private:
  void* data_ = nullptr;
  size_t bytes_ = 0;
  int range_ = -1;
};

// kUsage when `path` is there and is no regular file and no link: a device or a pipe must not be
// replaced by a file, whatever was forced.
Result<void> refuse_special_file(const std::filesystem::path& path);

Result<void> rename_file(const std::filesystem::path& from, const std::filesystem::path& to,
                         bool replace);
// Makes a rename inside `directory` durable.
Result<void> sync_directory(const std::filesystem::path& directory);

}  // namespace spool::format
