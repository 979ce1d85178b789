// Writes an analytic scene as a .spool file, tile by tile: radiance, film positions, the exact
// reference with zero variance, and the exact variance of one sample (infinite where it has none).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include "formats/spool_writer.h"
#include "lib/core/error.h"
#include "lib/synthetic/synthetic_scenes.h"

namespace spool {

struct WriteSyntheticOptions {
  SyntheticOptions scene;
  format::WriterOptions writer;
  int tile_size = 64;                    // pixels, as formats/spool.md allows
  int block_spp = 32;                    // samples
  std::function<void(double)> progress;  // share of the work done, may be empty
};

// Errors: kUsage for an unknown scene or sizes beyond the format's limits, kIo, and kUsage when the
// file exists.
Result<void> write_synthetic(std::string_view name, int width, int height, int spp,
                             std::uint64_t seed, const std::filesystem::path& path,
                             const WriteSyntheticOptions& options = {});

}  // namespace spool
