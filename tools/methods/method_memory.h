// What a method takes of memory beside the samples, so that what will not fit is refused before
// work. Measured on pictures of 256 x 256 and 512 x 512 pixels; tests/tools/test_memory.py measures
// again and holds each within 10 %.
#pragma once

#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/pool/load_recording.h"
#include "tools/methods/method_settings.h"

namespace spool::tools {

// What a method asks for with its options chosen.
struct Demands {
  Needs needs;
  WorkingMemory memory;
};
template <class Function>
Demands demands_of(const ChosenMethod<Function>& chosen) {
  return {chosen.ready.needs, chosen.ready.memory};
}
template <class Function>
std::vector<Demands> demands_of(const std::vector<ChosenMethod<Function>>& chosen) {
  std::vector<Demands> all;
  for (const ChosenMethod<Function>& method : chosen)
    all.push_back(demands_of(method));
  return all;
}

// The same of methods that are made for this alone: those of a plan.
struct PlanDemands {
  std::vector<Demands> samplers, filters;
};
Result<PlanDemands> demands_of(const std::vector<MethodChoice>& samplers,
                               const std::vector<MethodChoice>& filters);

// A sampler with the filter in its loop, if there is one.
WorkingMemory sampling_memory(const Demands& sampler, const std::vector<Demands>& filters,
                              int pieces_per_side);
WorkingMemory filtering_memory(const Demands& filter, int pieces_per_side);
// With the images that are kept to be shown, of the families that there are: roughly, as how many a
// family has is known only when they are made.
WorkingMemory with_views(WorkingMemory memory, const std::vector<ViewDescription>& known,
                         const Views& views, int pieces_per_side);
// The most that one of the cells of an evaluation takes; `halves`: with its spread measured.
WorkingMemory evaluation_memory(const std::vector<Demands>& samplers,
                                const std::vector<Demands>& filters, int pieces_per_side,
                                bool halves = false);

// Film positions of each sample where one of the methods asks for them, or pieces of a pixel do:
// what a method does not say it needs, it does not get.
SampleFilm film_for(const std::vector<Demands>& samplers, const std::vector<Demands>& filters,
                    int pieces_per_side);

}  // namespace spool::tools
