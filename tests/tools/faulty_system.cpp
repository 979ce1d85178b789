// Put before the system's library by LD_PRELOAD: calls that fail as on a file system without locks
// or a failing disk.
//   FAULT_FLOCK=ERRNO                  every flock
//   FAULT_READ=TEXT, FAULT_FSTAT=TEXT  of files whose path holds TEXT: EIO
#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

bool strikes(const char* variable, int fd) {
  const char* wanted = std::getenv(variable);
  if (wanted == nullptr) return false;
  char link[64], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = ::readlink(link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = '\0';
  // The process's own folder has its number in the path.
  const char* self = std::strncmp(path, "/proc/", 6) == 0 ? std::strchr(path + 6, '/') : nullptr;
  if (std::strncmp(wanted, "/proc/self/", 11) == 0 && self != nullptr)
    return std::strcmp(self + 1, wanted + 11) == 0;
  return std::strstr(path, wanted) != nullptr;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int fail(int error) {
  errno = error;
  return -1;
}

}  // namespace

extern "C" {

int flock(int fd, int operation) {
  if (const char* error = std::getenv("FAULT_FLOCK")) return fail(std::atoi(error));
  return next<int (*)(int, int)>("flock")(fd, operation);
}

ssize_t read(int fd, void* bytes, size_t size) {
  if (strikes("FAULT_READ", fd)) return fail(EIO);
  return next<ssize_t (*)(int, void*, size_t)>("read")(fd, bytes, size);
}

ssize_t pread(int fd, void* bytes, size_t size, off_t at) {
  if (strikes("FAULT_READ", fd)) return fail(EIO);
  return next<ssize_t (*)(int, void*, size_t, off_t)>("pread")(fd, bytes, size, at);
}

ssize_t pread64(int fd, void* bytes, size_t size, off64_t at) {
  if (strikes("FAULT_READ", fd)) return fail(EIO);
  return next<ssize_t (*)(int, void*, size_t, off64_t)>("pread64")(fd, bytes, size, at);
}

ssize_t readv(int fd, const iovec* parts, int count) {
  if (strikes("FAULT_READ", fd)) return fail(EIO);
  return next<ssize_t (*)(int, const iovec*, int)>("readv")(fd, parts, count);
}

int fstat(int fd, struct stat* info) noexcept {
  if (strikes("FAULT_FSTAT", fd)) return fail(EIO);
  return next<int (*)(int, struct stat*)>("fstat")(fd, info);
}
}
