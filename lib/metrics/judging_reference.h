// What an estimate is judged by.
#pragma once

#include <memory>
#include <optional>

#include "lib/core/image.h"
#include "lib/metrics/reference_side.h"

namespace spool {

struct JudgingReference {
  RgbImage mean;                        // R
  std::optional<RgbImage> variance;     // b, variance of `mean`; absent: taken as exact
  std::optional<RgbImage> denominator;  // D of relMSE and of the deciles; absent: R
  std::shared_ptr<KeptSide> kept = {};  // of this R and D; absent: its side is made for each image
};

}  // namespace spool
