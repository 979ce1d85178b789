#include "formats/interchange/lz4_frame.h"

#include <memory>

#include <lz4frame.h>

namespace spool::interchange {

Result<void> decode_lz4_frame(std::span<const std::byte> stored, std::span<std::byte> out,
                              std::string_view name) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return fail(ErrorCode::kIo, "{}: no memory for a decoder: free some", name);
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      raw, LZ4F_freeDecompressionContext);
  size_t taken = 0, given = 0, hint = 1;
  while (hint != 0) {
    size_t space = out.size() - given, left = stored.size() - taken;
    hint = LZ4F_decompress(context.get(), out.data() + given, &space, stored.data() + taken, &left,
                           nullptr);
    if (LZ4F_isError(hint))
      return fail(ErrorCode::kDamage, "{}: not an LZ4 frame ({}): fetch the file again", name,
                  LZ4F_getErrorName(hint));
    given += space;
    taken += left;
    if (hint != 0 && space == 0 && left == 0) break;  // requires more than there is, or more room
  }
  if (hint != 0 || given != out.size() || taken != stored.size())
    return fail(
        ErrorCode::kDamage,
        "{}: the frame gives {} of {} bytes and {} of its own are left: the file is damaged", name,
        given, out.size(), stored.size() - taken);
  return {};
}

}  // namespace spool::interchange
