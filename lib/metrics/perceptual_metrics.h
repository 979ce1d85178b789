// SSIM, MS-SSIM and FLIP of two radiance images, with bootstrap standard errors.
//
// SSIM, MS-SSIM and LDR-FLIP look at the images tone-mapped by the reference's exposure
// (tone_map.h), HDR-FLIP at the radiance. Unlike squared errors they cannot be debiased: noise in
// the reference counts as error, so they require a clean one. Standard errors resample the pixels'
// values by blocks; a value belongs to the block of its window's centre.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/metrics/bootstrap.h"
#include "lib/metrics/reference_side.h"

namespace spool {

// Which of them are computed; HDR-FLIP costs several times what all others do.
enum class Perceptual { kNone, kFast, kAll };

struct PerceptualValue {
  std::string name;
  Estimate estimate;              // NaN: not asked for, or not defined
  std::vector<double> resampled;  // [resample], empty where there is no standard error
};

// What they are made of. Planes may be empty where nothing wanted is made of them.
struct PerceptualInputs {
  const RgbImage& estimate;
  const RgbImage& reference;
  const ReferenceSide& side;  // of the judged pixels
  const Plane& luma;          // of the tone-mapped estimate, NaN where not judged
};

struct PerceptualTable {
  std::vector<PerceptualValue> values;  // ssim, ms_ssim, flip_ldr, flip_hdr
  Plane flip;                           // flip_ldr of each pixel, 0 where not judged; or empty
};

// Those that `wanted` says yes to and `which` holds; the others are NaN. Pixels with judged == 0
// are left out; windows of SSIM that hold one are too.
PerceptualTable perceptual_metrics(const PerceptualInputs& inputs, const BlockBootstrap& bootstrap,
                                   Perceptual which, GuardCounts& guards,
                                   const std::function<bool(std::string_view)>& wanted);

// flip_ldr of each pixel as above, the side with its FLIP view.
Plane flip_map(const RgbImage& estimate, const ReferenceSide& side);

}  // namespace spool
