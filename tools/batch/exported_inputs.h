// Inputs for a denoiser that runs elsewhere: `spool evaluate --export-inputs DIR`.
//
// One EXR of every replicate, and of the halves of those whose spread is measured: R, G, B, the
// variance of the mean, n, and the means and variances of the features that were recorded, as
// tools/methods/statistics_file.h has them. DIR/plan.toml and DIR/dumps.json say of what.
#pragma once

#include "tools/batch/run_request.h"
#include "tools/terminal/console.h"

namespace spool::tools {

// Inputs that are there stay. kUsage where `request.inputs` holds those of another plan, kData
// where a sampler failed.
Result<void> export_inputs(const RunRequest& request, const CommonOptions& common);

}  // namespace spool::tools
