#include "formats/interchange/scratch_file.h"

namespace spool::interchange {

Result<format::FileHandle> open_scratch_file(const std::filesystem::path& out) {
  std::filesystem::path name = out;
  name += ".scratch";
  SPOOL_ASSIGN(format::FileHandle file, format::FileHandle::open(name, format::OpenMode::kCreate));
  std::error_code ignored;
  std::filesystem::remove(name, ignored);  // lives as long as it is open
  return file;
}

Result<void> refuse_existing_target(const std::filesystem::path& out, bool force) {
  std::error_code ignored;
  if (force || !std::filesystem::exists(out, ignored)) return {};
  return fail(ErrorCode::kUsage, "{}: exists: choose another name or use --force", out.string());
}

}  // namespace spool::interchange
