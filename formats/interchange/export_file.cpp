#include "formats/interchange/export_file.h"

#include <cstring>

namespace spool::interchange {

Result<void> write_whole_file(const std::filesystem::path& out, bool force,
                              const std::function<Result<void>(format::FileHandle&)>& fill) {
  std::error_code ignored;
  if (!force && std::filesystem::exists(out, ignored))
    return fail(ErrorCode::kUsage, "{}: exists: choose another name or use --force", out.string());
  std::filesystem::path partial = out;
  partial += ".partial";
  if (force) std::filesystem::remove(partial, ignored);
  const auto write = [&]() -> Result<void> {
    SPOOL_ASSIGN(format::FileHandle file,
                 format::FileHandle::open(partial, format::OpenMode::kCreate));
    SPOOL_TRY(fill(file));
    SPOOL_TRY(file.sync());
    SPOOL_TRY(file.close());
    SPOOL_TRY(format::rename_file(partial, out, force));
    return format::sync_directory(out.has_parent_path() ? out.parent_path() : ".");
  };
  if (std::filesystem::exists(partial, ignored))
    return fail(ErrorCode::kUsage, "{}: exists: remove it or use --force", partial.string());
  const Result<void> written = write();
  if (!written) std::filesystem::remove(partial, ignored);
  return written;
}

std::vector<std::byte> interleave(const std::vector<std::vector<std::byte>>& blocks,
                                  const std::vector<uint32_t>& samples, uint64_t pixels,
                                  uint32_t first_channel, uint32_t channels, uint32_t bytes) {
  uint64_t total = 0;
  for (uint32_t count : samples)
    total += count;
  std::vector<std::byte> out(pixels * total * channels * bytes);
  uint64_t before = 0;  // samples of earlier blocks
  for (size_t b = 0; b < blocks.size(); ++b) {
    const uint64_t count = samples[b];
    for (uint64_t c = 0; c < channels; ++c) {
      const std::byte* from = blocks[b].data() + (first_channel + c) * pixels * count * bytes;
      for (uint64_t p = 0; p < pixels; ++p) {
        for (uint64_t s = 0; s < count; ++s) {
          std::memcpy(&out[((p * total + before + s) * channels + c) * bytes], from, bytes);
          from += bytes;
        }
      }
    }
    before += count;
  }
  return out;
}

}  // namespace spool::interchange
