// Images made elsewhere in an evaluation: checks before hours of work, and one that is the
// reference.
#pragma once

#include <string>
#include <vector>

#include "lib/core/image.h"
#include "lib/experiment/plan.h"

namespace spool::tools {

// kUsage where two cells have one file although their samples differ, or where a cell asks for
// images of halves that decide; `pattern` is a file name as of tools/methods/replicate_images.h.
Result<void> check_image_names(const Plan& plan, const std::string& pattern, const std::string& of);

// The same of the plan's filters that are images of replicates; and kIo where files of `cells`, of
// which results are still wanted, are missing.
Result<void> check_given_images(const Plan& plan, const std::vector<Cell>& cells);

}  // namespace spool::tools
