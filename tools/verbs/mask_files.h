// Masks for the energy ratio, from image files.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/metrics/energy_masks.h"

namespace spool::tools {

// "NAME=FILE", of the size of an image; kUsage for other texts.
Result<std::vector<EnergyMask>> read_energy_masks(const std::vector<std::string>& texts,
                                                  const NeededSize& needed);

// The planes of a plan's masks; kData where one is not as large as each recording that it is for.
Result<void> read_masks(Plan& plan);

}  // namespace spool::tools
