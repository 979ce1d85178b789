// How much memory a piece of work takes beside the samples it is given.
#pragma once

namespace spool {

// Memory that will be wanted for work on a recording, beside its samples and its reference.
struct WorkingMemory {
  double per_pixel = 0.0, fixed = 0.0;  // bytes
};

}  // namespace spool
