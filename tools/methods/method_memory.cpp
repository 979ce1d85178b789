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
// An image that is shown: as it was made, and as it is written.
constexpr double kView = 20;

// One that cannot be made takes what the method takes with its default options.
template <class Function>
WorkingMemory memory_of(const MethodList<Function>& known, const MethodChoice& choice) {
  const Method<Function>* method = find_method(known, choice.name);
  WorkingMemory memory = method == nullptr ? kUnmeasuredMemory : method->memory;
  if (const auto made = make_method(known, choice)) {
    memory.per_pixel += made->beside.per_pixel;
    memory.fixed += made->beside.fixed;
  }
  return memory;
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
std::vector<MethodChoice> in_loop_of(const MethodChoice& sampler,
                                     const std::vector<MethodChoice>& filters) {
  const auto made = make_method(known_samplers(), sampler);
  if (!made || !made->needs.filter_in_loop) return {};
  if (made->needs.loop_filter.empty()) return filters;
  const auto named = loop_choice(made->needs, {});
  return named ? std::vector{*named} : std::vector<MethodChoice>{};
}

// A method that cannot be made says so elsewhere.
template <class Function>
bool uses_film(const MethodList<Function>& known, const MethodChoice& choice) {
  const auto made = make_method(known, choice);
  return !made || made->needs.film_positions != Use::kNone;
}

}  // namespace

SampleFilm film_for(const std::vector<MethodChoice>& samplers,
                    const std::vector<MethodChoice>& filters, int pieces_per_side) {
  const auto filter_does = [](const MethodChoice& c) { return uses_film(known_filters(), c); };
  const auto sampler_does = [&](const MethodChoice& c) {
    return uses_film(known_samplers(), c) ||
           std::ranges::any_of(in_loop_of(c, filters), filter_does);
  };
  const bool wanted = pieces_per_side > 1 || std::ranges::any_of(samplers, sampler_does) ||
                      std::ranges::any_of(filters, filter_does);
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

WorkingMemory filtering_memory(const MethodChoice& filter, int pieces_per_side) {
  return on_pieces(memory_of(known_filters(), filter), pieces_per_side);
}

WorkingMemory sampling_memory(const MethodChoice& sampler, const std::vector<MethodChoice>& filters,
                              int pieces_per_side) {
  const Sampler* known = find_method(known_samplers(), sampler.name);
  if (known == nullptr || !known->needs.filter_in_loop) {
    return on_pieces(memory_of(known_samplers(), sampler), pieces_per_side);
  }
  WorkingMemory loop;
  for (const MethodChoice& filter : in_loop_of(sampler, filters))
    loop = larger(loop, memory_of(known_filters(), filter));
  const WorkingMemory own = known->memory;
  return on_pieces(
      {own.per_pixel + loop.per_pixel - kSharedWithLoop, std::max(own.fixed, loop.fixed)},
      pieces_per_side);
}

WorkingMemory evaluation_memory(const std::vector<MethodChoice>& samplers,
                                const std::vector<MethodChoice>& filters, int pieces_per_side) {
  WorkingMemory most;
  for (const MethodChoice& sampler : samplers)
    most = larger(most, sampling_memory(sampler, filters, pieces_per_side));
  WorkingMemory filtering;
  for (const MethodChoice& filter : filters)
    filtering = larger(filtering, filtering_memory(filter, pieces_per_side));
  filtering.per_pixel = std::max(filtering.per_pixel + kHeldWhileFiltering, kJudging);
  return larger(most, filtering);
}

}  // namespace spool::tools
