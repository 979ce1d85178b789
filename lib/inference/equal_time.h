// The error of one method in the time that another took: read from its own errors over its own
// times, straight between them on logarithmic axes, and never beyond them.
#pragma once

#include <span>

#include "lib/inference/intervals.h"

namespace spool {

struct TimedError {
  double seconds = 0;  // processor time of an image
  const Series* error = nullptr;
};

struct EqualTime {
  Interval ratio;         // of the error to the target, in the target's time
  bool too_slow = false;  // takes more than the target's time at its smallest budget
  bool too_fast = false;  // takes less at its largest
  bool known() const { return ratio.n > 0; }
};

// `curve`: the budgets of one method, in any order. `target`: the other, on the same replicates.
EqualTime equal_time(std::span<const TimedError> curve, const TimedError& target);

}  // namespace spool
