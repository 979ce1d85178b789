#include "tools/methods/method_memory.h"

#include <algorithm>

#include "lib/experiment/loop_filter.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

// What a filter in the loop adds to the statistics that its sampler holds.
constexpr double kSharedWithLoop = 39;
// A sampling run stays while its images are filtered, and metrics take the same whatever they
// judge.
constexpr double kHeldWhileFiltering = 150, kJudging = 460;
// With what two halves of the recording gave, and the error maps of their images.
constexpr double kJudgingHalves = 785;
// An image that is shown: as it was made, and as it is written.
constexpr double kView = 18;

template <class Function>
Result<std::vector<Demands>> demands_of(const MethodList<Function>& known,
                                        const std::vector<MethodChoice>& choices) {
  std::vector<Demands> all;
  for (const MethodChoice& choice : choices) {
    SPOOL_ASSIGN(const Ready<Function> made, make_method(known, choice));
    all.push_back({made.needs, made.memory});
  }
  return all;
}

// Images of a family, by the letters behind its name: levels and scales, directions, channels.
double images_of(const ViewDescription& family) {
  double images = 1.0;
  for (std::size_t dot = family.name.find('.'); dot != std::string::npos;
       dot = family.name.find('.', dot + 1)) {
    const std::string index = family.name.substr(dot + 1, family.name.find('.', dot + 1) - dot - 1);
    images *= index == "i" ? 8.0 : index == "c" ? 3.0 : 5.0;
  }
  return images;
}

WorkingMemory on_pieces(WorkingMemory memory, int pieces_per_side) {
  memory.per_pixel *= pieces_per_side * pieces_per_side;
  return memory;
}

WorkingMemory larger(const WorkingMemory& a, const WorkingMemory& b) {
  return {std::max(a.per_pixel, b.per_pixel), std::max(a.fixed, b.fixed)};
}

// What a sampler has in its loop: the filter that it names, else those beside it.
std::vector<Demands> in_loop_of(const Demands& sampler, const std::vector<Demands>& filters) {
  if (!sampler.needs.filter_in_loop) return {};
  if (sampler.needs.loop_filter.empty()) return filters;
  const auto named = loop_choice(sampler.needs, {});
  if (!named) return {};  // the run of the sampler reports it
  return demands_of(known_filters(), {*named}).value_or(std::vector<Demands>{});
}

bool uses_film(const Demands& method) {
  return method.needs.film_positions != Use::kNone;
}

}  // namespace

Result<PlanDemands> demands_of(const std::vector<MethodChoice>& samplers,
                               const std::vector<MethodChoice>& filters) {
  PlanDemands all;
  SPOOL_ASSIGN(all.samplers, demands_of(known_samplers(), samplers));
  SPOOL_ASSIGN(all.filters, demands_of(known_filters(), filters));
  return all;
}

SampleFilm film_for(const std::vector<Demands>& samplers, const std::vector<Demands>& filters,
                    int pieces_per_side) {
  const bool wanted =
      pieces_per_side > 1 || std::ranges::any_of(filters, uses_film) ||
      std::ranges::any_of(samplers, [&](const Demands& sampler) {
        return uses_film(sampler) || std::ranges::any_of(in_loop_of(sampler, filters), uses_film);
      });
  return wanted ? SampleFilm::kLoad : SampleFilm::kLeaveOut;
}

WorkingMemory with_views(WorkingMemory memory, const std::vector<ViewDescription>& known,
                         const Views& views, int pieces_per_side) {
  double images = 0.0;
  for (const ViewDescription& family : known) {
    if (views.wants(family.name.substr(0, family.name.find('.')))) images += images_of(family);
  }
  memory.per_pixel += kView * images * pieces_per_side * pieces_per_side;
  return memory;
}

WorkingMemory filtering_memory(const Demands& filter, int pieces_per_side) {
  return on_pieces(filter.memory, pieces_per_side);
}

WorkingMemory sampling_memory(const Demands& sampler, const std::vector<Demands>& filters,
                              int pieces_per_side) {
  const WorkingMemory& own = sampler.memory;
  if (!sampler.needs.filter_in_loop) return on_pieces(own, pieces_per_side);
  WorkingMemory loop;
  for (const Demands& filter : in_loop_of(sampler, filters))
    loop = larger(loop, filter.memory);
  return on_pieces(
      {own.per_pixel + loop.per_pixel - kSharedWithLoop, std::max(own.fixed, loop.fixed)},
      pieces_per_side);
}

WorkingMemory evaluation_memory(const std::vector<Demands>& samplers,
                                const std::vector<Demands>& filters, int pieces_per_side,
                                bool halves) {
  WorkingMemory most;
  for (const Demands& sampler : samplers)
    most = larger(most, sampling_memory(sampler, filters, pieces_per_side));
  WorkingMemory filtering;
  for (const Demands& filter : filters)
    filtering = larger(filtering, filtering_memory(filter, pieces_per_side));
  filtering.per_pixel =
      std::max(filtering.per_pixel + kHeldWhileFiltering, halves ? kJudgingHalves : kJudging);
  return larger(most, filtering);
}

}  // namespace spool::tools
