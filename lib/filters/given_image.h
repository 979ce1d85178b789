// An image made elsewhere, as a filter: for filters outside this program.
#pragma once

#include <string>

#include "lib/filters/filter.h"

namespace spool {

// `image` as the result for a recording of its size; `name` stands in the error of any other size,
// and of values that are not finite.
Result<Reconstruction> own_image(RgbImage image, const SamplePool& pool, const std::string& name);

// Hands `image` back for any selection of its size. Refuses half pools: a sampler that compares the
// images of two halves would find no difference.
FilterFunction given_image(RgbImage image, std::string name);

}  // namespace spool
