// Sizes that stand alone give way: a dot in the image is a piece whose few samples agree by chance.
//
//   level = max(level, fifth smallest level of the 5 x 5 pieces around it)
//
// A line across the window has five pieces and stays, a dot or a pair goes. So does a piece that
// kept its own mean (base_step.h), unless it is more than kLampRatio times the median around it: a
// lamp of one piece stays, too. Beyond the image lie its border pieces again.
// Slow twin: tests/reference/lone_sizes_reference.h.
#pragma once

#include "lib/core/image.h"

namespace spool {

inline constexpr double kLampRatio = 4.0;

// `kept`: above 0 where a piece kept its mean; may be empty. `mean`: of the analysis signal.
CountImage without_lone_sizes(const CountImage& level, const Plane& kept, const Plane& mean);

}  // namespace spool
