// The anisotropic mean of anisotropic_filter.h over single samples at their film positions.
#pragma once

#include "lib/core/guards.h"
#include "lib/filters/directional/anisotropic_filter.h"
#include "lib/filters/directional/filter_width.h"
#include "lib/filters/directional/options.h"
#include "lib/pool/sample_pool.h"

namespace spool {

// Only samples behind the cursor, i < n(x, y), are read. The grid of `input` starts at piece
// (x0, y0) of the pool.
template <class T>
FilteredPieces filter_samples(const FilterInput& input, const FilterWidths<T>& widths,
                              const SamplePool& pool, int x0, int y0, const FilterOptions& options,
                              GuardCounts& guards);

}  // namespace spool
