// A loop over rows that stays on the calling thread when the area is small.
//
// Local updates touch a few hundred pixels, where the start of a parallel loop costs more than it
// saves. Which way is taken never changes a result.
#pragma once

#include "lib/core/parallel.h"

namespace spool {

inline constexpr long long kSerialArea = 8192;

// body(y) for y = begin .. end-1; `area` is the number of pixels written in all.
template <class Body>
void rows_by_area(int begin, int end, long long area, Body&& body) {
  if (area >= kSerialArea) {
    parallel_rows(begin, end, body);
  } else {
    for (int y = begin; y < end; ++y)
      body(y);
  }
}

}  // namespace spool
