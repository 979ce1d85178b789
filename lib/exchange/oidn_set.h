// Images as Open Image Denoise's tools and trainer [Oidn] name them: export.
//
// NAME_0008spp.hdr.exr, .alb.exr and .nrm.exr for each sample count, and NAME_ref.hdr.exr (.alb,
// .nrm of all samples): means of the first samples of each pixel, FLOAT R, G, B.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/interchange/export_format.h"
#include "lib/core/error.h"

namespace spool::exchange {

struct OidnSetOptions : interchange::ExportOptions {
  std::vector<uint32_t> spp;  // of the inputs; empty: 1, 2, 4, ... up to what was recorded
  std::string name;           // empty: the stem of the recording
};

// Into the folder `out`. Errors: kData for a recording without a reference of other seeds (the
// largest input would become the target and contain the inputs), and for what is not finite.
Result<interchange::ExportReport> export_oidn_set(const std::filesystem::path& in,
                                                  const std::filesystem::path& out,
                                                  const OidnSetOptions& options = {});

interchange::ExportFormat oidn_target();

}  // namespace spool::exchange
