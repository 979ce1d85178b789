// What all exporters share: a file that appears whole or not at all, and layers as arrays.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "formats/file_handle.h"
#include "formats/spool_reader.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Calls `fill` on a new file beside OUT, syncs and renames it. On failure nothing is left behind.
// kUsage when OUT exists and `force` is not set; kIo when another process wrote OUT meanwhile.
Result<void> write_whole_file(const std::filesystem::path& out, bool force,
                              const std::function<Result<void>(format::FileHandle&)>& fill);

// What an export gave up or noticed: one line each, for the user.
struct ExportReport {
  std::vector<std::string> notes;
};

// The numbers of a layer as [y][x][s][c] (pixel: [y][x][c], pass: [s][c]) at `data_offset`, bit for
// bit, or f16 widened to f32 where `type` says so. Every block must be present. Memory: about 64
// MiB.
Result<void> write_layer(const format::SpoolReader& dump, const format::LayerInfo& layer,
                         format::DataType type, uint64_t data_offset, format::FileHandle& out);

}  // namespace spool::interchange
