// What all exporters share: OUT.partial that becomes OUT when it is whole, and blocks as pixels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "formats/file_handle.h"
#include "formats/spool_reader.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Calls `fill` on a new OUT.partial, syncs and renames it. On failure nothing is left behind.
// kUsage when OUT exists and `force` is not set.
Result<void> write_whole_file(const std::filesystem::path& out, bool force,
                              const std::function<Result<void>(format::FileHandle&)>& fill);

// Elements [y][x][s][c] of one layer out of blocks [c][y][x][s] that follow each other in one tile,
// bit for bit. `bytes` per element.
std::vector<std::byte> interleave(const std::vector<std::vector<std::byte>>& blocks,
                                  const std::vector<uint32_t>& samples, uint64_t pixels,
                                  uint32_t first_channel, uint32_t channels, uint32_t bytes);

}  // namespace spool::interchange
