// Directional: every piece is averaged over a neighbourhood whose size follows bias and variance
// and whose shape follows the direction of the structure around it [LiuZheng (section 4)].
//
// Works on any selection; without attenuation the literal forms of eq 9's factor use 0.10. Level 0
// is no filter: the base image. With recon_scope = tile each tile is analysed and filtered as if it
// were the whole image, which shows at its borders.
#pragma once

#include "lib/filters/directional/options.h"
#include "lib/filters/filter.h"

namespace spool {

// Errors kData: no sample at all; attenuation of another size than the selection.
Result<Reconstruction> reconstruct_directional(const Selection& selection, const SamplePool& pool,
                                               const DirectionalOptions& options,
                                               const FilterContext& context);

Filter directional_filter();

}  // namespace spool
