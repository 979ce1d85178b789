#include "lib/image_io/png_writer.h"

#include <dlfcn.h>
#include <array>
#include <cstdlib>
#include <span>

#include "lib/image_io/atomic_file.h"

namespace spool {
namespace {

using TakeBytes = void (*)(void*, const unsigned char*, std::size_t);
using MakePng = int (*)(int, int, const unsigned char*, TakeBytes, void*, char*, std::size_t);
using Bytes = std::vector<unsigned char>;

// In lib/spool beside `binary` or up to two folders above.
std::filesystem::path module_near(const std::filesystem::path& binary) {
  std::error_code status;
  std::filesystem::path folder = binary.parent_path();
  for (int up = 0; up < 3; ++up, folder = folder.parent_path()) {
    std::filesystem::path candidate = folder / "lib" / "spool" / "spool_png.so";
    if (std::filesystem::exists(candidate, status)) return candidate;
  }
  return {};
}

Result<std::filesystem::path> find_module() {
  const char* named = std::getenv("SPOOL_PNG_MODULE");
  if (named && *named) return std::filesystem::path(named);
  std::error_code status;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", status);
  std::filesystem::path found = module_near(program);
  // The program may be an interpreter, and this code a part of a library that it opened.
  Dl_info here{};
  if (found.empty() && ::dladdr(reinterpret_cast<const void*>(&find_module), &here) != 0) {
    found = module_near(here.dli_fname);
  }
  if (!found.empty()) return found;
  return fail(
      ErrorCode::kIo,
      "spool_png.so: not found in lib/spool near {}: PNG pictures need it; build the target "
      "spool_png or set SPOOL_PNG_MODULE",
      program.string());
}

Result<MakePng> load_module() {
  SPOOL_ASSIGN(const std::filesystem::path path, find_module());
  // Never closed: libraries with threads of their own do not survive being unloaded.
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = module ? ::dlsym(module, "spool_make_png") : nullptr;
  if (!function) {
    return fail(ErrorCode::kIo, "{}: cannot be loaded ({}): PNG pictures need it", path.string(),
                ::dlerror());
  }
  return reinterpret_cast<MakePng>(function);
}

}  // namespace

Result<Bytes> png_bytes(const Picture& picture) {
  static const Result<MakePng> make = load_module();
  if (!make) return tl::unexpected<Error>(make.error());
  std::array<char, 512> error{};
  Bytes png;
  const TakeBytes take = [](void* context, const unsigned char* bytes, std::size_t count) {
    static_cast<Bytes*>(context)->assign(bytes, bytes + count);
  };
  if ((*make)(picture.width, picture.height, picture.rgb.data(), take, &png, error.data(),
              error.size()) != 0) {
    return fail(ErrorCode::kIo, "a PNG cannot be made ({})", error.data());
  }
  return png;
}

Result<void> write_png(const std::filesystem::path& path, const Picture& picture, bool overwrite,
                       bool shared) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(path, overwrite, shared));
  const Result<Bytes> png = png_bytes(picture);
  if (!png) return fail(png.error().code, "{}: {}", path.string(), png.error().message);
  SPOOL_TRY(file.file().write_at(0, std::as_bytes(std::span(*png))));
  return file.commit();
}

}  // namespace spool
