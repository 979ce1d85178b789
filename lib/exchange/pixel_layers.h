// Layers with one value per pixel, as a flat EXR beside the samples.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/error.h"
#include "lib/exchange/dump_layers.h"

namespace spool::exchange {

// What is said of `images` of `all` files whose compression changes values.
std::string lossy_remark(const std::string& compression, size_t images, size_t all);

// Planes of pixel scope as a flat EXR.
Result<void> write_pixel_layers(const format::SpoolReader& dump, ScratchLayers& scratch,
                                const std::filesystem::path& path);
// Adds the pixel layers of such a file to `plan`, its numbers at the end of `scratch`. kData for
// one that was exported from another recording than `source`, and when a layer is missing that the
// recording had.
Result<void> read_pixel_layers(const std::optional<ToldDump>& told, const std::string& source,
                               const std::filesystem::path& path, uint64_t& end,
                               format::FileHandle& scratch, interchange::DumpPlan& plan);

}  // namespace spool::exchange
