// Folders of recorded passes -> one .spool file, in bounded memory.
//
// Several folders are joined when they hold disjoint passes of the same recording: all settings
// agree, no seed occurs twice (in mode sequence: no sample index). Their order is the order of the
// samples. Groups of the recording: radiance; features (f16 layers); measures (f32 layers); film
// and seed (pass scope); reference and reference_variance (pixel scope).
//
// Errors: kIo, kData and kDamage as in formats/pass_manifest.h; kUsage no folder, target exists;
// kData where folders do not belong together or a value does not fit f16.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/pass_plan.h"
#include "lib/core/error.h"

namespace spool::format {

struct PackReport {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t spp = 0;
  uint64_t reference_spp = 0;  // 0: no reference
  uint32_t batches = 0;
  double cost_per_sample =
      0.0;  // CPU (or wall) seconds of a sample, median of the passes; 0 unknown
  std::vector<std::string> layers;
  uint64_t bytes = 0;  // size of the recording
  std::string remark;  // on the samples, where there is one
};

Result<PackReport> pack_passes(const std::vector<std::filesystem::path>& folders,
                               const std::filesystem::path& out, const PackOptions& options = {});

}  // namespace spool::format
