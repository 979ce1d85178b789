// The statistics images that the denoiser of BCD [Bcd] reads: export.
//
// P.exr (mean), P_cov.exr (covariance of the samples, unbiased) and P_hist.exr (histograms of the
// three components, then the count of samples). Its result comes back as `--filter image:FILE`.
#pragma once

#include <filesystem>
#include <string>

#include "formats/interchange/export_format.h"
#include "lib/core/error.h"

namespace spool::exchange {

struct BcdStatisticsOptions : interchange::ExportOptions {
  int spp = 0;            // the first so many of each pixel; 0: all
  std::string selection;  // or an image of counts, channel n
};

// `out`: P or P.exr. Errors: kData for samples that are not finite (with pixel and sample), fewer
// than two samples in a pixel, selections of another size or beyond what was recorded.
Result<interchange::ExportReport> export_bcd_statistics(const std::filesystem::path& in,
                                                        const std::filesystem::path& out,
                                                        const BcdStatisticsOptions& options = {});

interchange::ExportFormat bcd_statistics_target();

inline constexpr int kBcdBins = 20;

}  // namespace spool::exchange
