// Energy in parts of the image that people point at: sum of the estimate / sum of the reference.
#pragma once

#include <string>

#include "lib/core/error.h"
#include "lib/metrics/error_metrics.h"

namespace spool {

struct EnergyMask {
  std::string name;
  std::string recording;  // file name of the recording it belongs to; empty: any
  std::string path;       // where it came from, for messages
  Plane plane;            // [y][x]: pixels above 0.5 belong to the part
};

// Sum over the finite pixels of the mask and all channels, with the standard error of the block
// bootstrap; not defined (NaN) where the reference is black. kData when the sizes differ.
Result<MetricValue> energy_in_mask(const RgbImage& estimate, const RgbImage& reference,
                                   const EnergyMask& mask, const BootstrapOptions& bootstrap = {});

}  // namespace spool
