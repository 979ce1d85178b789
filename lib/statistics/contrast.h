// Squared contrast of the samples of a piece, the summand of eq 6.
//
//   literal  ((max - min) / (max + min))^2, and 0 (counted) where |max + min| < 1e-30
//   guarded  C = (max - min) / (|max| + |min| + 1e-4), C^2: the same for positive samples up to the
//            epsilon, and in [0, 1] always. The literal form reaches 4e6 for 0.1 and -0.0999.
#pragma once

#include "lib/core/guards.h"

namespace spool {

enum class ContrastForm { kGuarded, kLiteral };

// Keeps the guarded contrast finite in black pieces; in units of the exposed signal (mean near 1).
inline constexpr double kContrastEpsilon = 1e-4;

double squared_contrast(double minimum, double maximum, ContrastForm form, GuardCounts& guards);

}  // namespace spool
