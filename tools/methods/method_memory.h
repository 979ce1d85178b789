// What a method takes of memory beside the samples, so that what will not fit is refused before
// work. Measured on pictures of 256 x 256 and 512 x 512 pixels; tests/tools/test_memory.py measures
// again and holds each within 10 %.
#pragma once

#include <string>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/pool/load_recording.h"

namespace spool::tools {

// A sampler with the filter in its loop, if there is one.
WorkingMemory sampling_memory(const MethodChoice& sampler, const std::vector<MethodChoice>& filters,
                              int pieces_per_side);
WorkingMemory filtering_memory(const MethodChoice& filter, int pieces_per_side);
// With the images that are kept to be shown, of the families that there are: roughly, as how many a
// family has is known only when they are made.
WorkingMemory with_views(WorkingMemory memory, const std::vector<ViewDescription>& known,
                         const Views& views, int pieces_per_side);
// The most that one of the cells of an evaluation takes.
WorkingMemory evaluation_memory(const std::vector<MethodChoice>& samplers,
                                const std::vector<MethodChoice>& filters, int pieces_per_side);

// Film positions of each sample where one of the methods asks for them, or pieces of a pixel do:
// what a method does not say it needs, it does not get.
SampleFilm film_for(const std::vector<MethodChoice>& samplers,
                    const std::vector<MethodChoice>& filters, int pieces_per_side);

}  // namespace spool::tools
