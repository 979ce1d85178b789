#include "formats/interchange/scratch_file.h"

#include <utility>

#include "formats/temporary_file.h"

namespace spool::interchange {

Result<format::FileHandle> open_scratch_file(const std::filesystem::path& out) {
  SPOOL_ASSIGN(format::TemporaryFile made, format::TemporaryFile::create(out));
  return std::move(made.file());  // its name goes with `made`: it lives as long as it is open
}

Result<void> refuse_existing_target(const std::filesystem::path& out, bool force) {
  std::error_code ignored;
  if (force || !std::filesystem::exists(out, ignored)) return {};
  return fail(ErrorCode::kUsage, "{}: exists: choose another name or use --force", out.string());
}

}  // namespace spool::interchange
