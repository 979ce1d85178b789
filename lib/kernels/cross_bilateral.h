// Cross-bilateral filters guided by features, and the choice of their scale by an unbiased estimate
// of the risk [LiWuChuang12].
//
//   w_pq = exp(-|p - q|^2 / (2 s^2)
//              - sum_f |f_p - f_q|^2 / (2 sigma_f^2 max(var_fp + var_fq, 0.01)))
//   F_s  = sum of w_pq y_q / sum of w_pq,      |q - p| <= round(2 s) in x and y
//   SURE = mean over channels of (F_s - y)^2 + 2 v w_pp / (sum of w_pq) - v
//
// s = 0 is the input itself. y, v: the image and its variance after the small pixel filter; the
// output is F_s of the means themselves, at the scale whose risk, smoothed with the weights of a
// scale of its own, is least (ties: the smallest). Windows are cut at the border. var_f is the
// sample variance, mean over the feature's channels (lib/kernels/feature_guide.h). Weights are
// float, sums double (lib/kernels/guided_means.h). With range=patches the candidates are those of
// cross non-local means, one for each tolerance instead of each s (lib/kernels/cross_patches.h).
// Slow twin: tests/reference/cross_bilateral_reference.h.
#pragma once

#include <vector>

#include "lib/core/error.h"
#include "lib/core/footprint.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/kernels/cross_patches.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

enum class CrossRange {
  kNone,     // features and distance alone: cross-bilateral
  kPatches,  // patches of the image, too: cross non-local means
};

struct CrossBilateralOptions {
  // s, pieces; ascending. The publication has every second.
  std::vector<double> scales = {0, 0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8};
  double risk_scale = 4.0;  // s of the smoothing of the risk
  CrossRange range = CrossRange::kNone;
  CrossPatchOptions patches;
  double sigma_normal = 0.8, sigma_albedo = 0.25, sigma_depth = 0.6;
};

OptionTable<CrossBilateralOptions> cross_bilateral_option_table();

struct CrossBilateralImage {
  RgbImage image;          // [c][y][x] pieces, radiance units
  CountImage scale;        // index of the candidate: into options.scales, or 1 + into the sigmas
  Plane risk;              // smoothed, of that scale; exposed units squared
  Plane variance;          // of y, mean over channels, exposed units squared
  std::vector<Plane> all;  // smoothed risk of each scale, where asked for
};

enum class RisksKept { kOfTheScale, kAll };

// Error kData when the recording has no feature, or no piece has a sample.
Result<CrossBilateralImage> cross_bilateral(const PieceStatistics& statistics,
                                            const SamplePool& pool, double exposure,
                                            const CrossBilateralOptions& options,
                                            GuardCounts& guards,
                                            RisksKept kept = RisksKept::kOfTheScale,
                                            Footprints* footprints = nullptr);

}  // namespace spool
