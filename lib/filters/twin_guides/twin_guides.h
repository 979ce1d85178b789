// twin_guides: local ridge regression on position and features, with weights from two guides that
// are made of the pixel's own samples.
//
// One guide is the logarithm of a small feature-guided mean, the other the mean of the samples'
// logarithms, which says something of their distribution and follows no single bright sample; each
// on two pyramid levels, every distance less its noise. Samples are clamped before it
// (lib/kernels/sample_clamp.h) and neighbours limited in the window. Features help and may be
// missing. A method of this project; distances less their noise are those of
// [RousselleKnausZwicker12], cleaned features those of [RousselleManziZwicker13], local regression
// on features of [MoonEtAl14] and [BitterliEtAl16]; docs/method.md.
// Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/filters/twin_guides/options.h"

namespace spool {

// Errors: kData when no piece has a sample; those of reading features.
Result<Reconstruction> reconstruct_twin_guides(const Selection& selection, const SamplePool& pool,
                                               const TwinGuidesOptions& options,
                                               const FilterContext& context);

Filter twin_guides_filter();

}  // namespace spool
