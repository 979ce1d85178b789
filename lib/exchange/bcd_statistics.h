// The statistics images that the denoiser of BCD [Bcd] reads: export.
//
// P.exr (mean), P_cov.exr (covariance of the samples, unbiased) and P_hist.exr (histograms of the
// three components, then the count of samples). Its result comes back as `--filter image:FILE`.
#pragma once

#include "formats/interchange/export_format.h"

namespace spool::exchange {

// Written to P or P.exr. Errors: kData for samples that are not finite (with pixel and sample),
// fewer than two samples in a pixel, selections of another size or beyond what was recorded.
interchange::ExportFormat bcd_statistics_target();

}  // namespace spool::exchange
