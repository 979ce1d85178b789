#include "tools/methods/method_memory.h"

#include <algorithm>
#include <string_view>

#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

constexpr double kMega = 1e6;

struct Measured {
  std::string_view name;
  WorkingMemory memory;
};

// Without the reference, which is counted with the recording.
constexpr Measured kSamplers[] = {
    {"uniform", {128, 2.0 * kMega}},         {"multiscale", {326, 2.9 * kMega}},
    {"mitchell", {172, 2.0 * kMega}},        {"adaptive_wavelet", {132, 2.0 * kMega}},
    {"greedy_error", {124, 2.0 * kMega}},    {"nl_means", {124, 2.0 * kMega}},
    {"cross_bilateral", {232, 4.2 * kMega}}, {"neyman", {156, 2.0 * kMega}},
};
constexpr Measured kFilters[] = {
    {"box", {188, 2.0 * kMega}},          {"gaussian", {188, 2.0 * kMega}},
    {"directional", {370, 2.6 * kMega}},  {"greedy_selection", {284, 2.0 * kMega}},
    {"nl_means", {215, 4.7 * kMega}},     {"cross_bilateral", {232, 3.8 * kMega}},
    {"multistage", {188, 2.0 * kMega}},   {"wavelet_shrinkage", {180, 2.0 * kMega}},
    {"oracle_scale", {220, 2.0 * kMega}},
};
// Methods of other people, whose own memory is theirs, and those that are not in the tables.
constexpr WorkingMemory kUnknown = {400, 5.0 * kMega};
// What a filter in the loop adds to the statistics that its sampler holds.
constexpr double kSharedWithLoop = 39;
// A sampling run stays while its images are filtered and judged.
constexpr double kJudging = 250;

template <std::size_t N>
WorkingMemory find(const Measured (&table)[N], const MethodChoice& choice) {
  const auto* found = std::find_if(std::begin(table), std::end(table),
                                   [&](const Measured& m) { return m.name == choice.name; });
  return found == std::end(table) ? kUnknown : found->memory;
}

WorkingMemory on_pieces(WorkingMemory memory, int pieces_per_side) {
  memory.per_pixel *= pieces_per_side * pieces_per_side;
  return memory;
}

WorkingMemory larger(const WorkingMemory& a, const WorkingMemory& b) {
  return {std::max(a.per_pixel, b.per_pixel), std::max(a.fixed, b.fixed)};
}

}  // namespace

WorkingMemory filtering_memory(const MethodChoice& filter, int pieces_per_side) {
  return on_pieces(find(kFilters, filter), pieces_per_side);
}

WorkingMemory sampling_memory(const MethodChoice& sampler, const std::vector<MethodChoice>& filters,
                              int pieces_per_side) {
  const Sampler* known = find_method(known_samplers(), sampler.name);
  if (known == nullptr || !known->needs.filter_in_loop) {
    return on_pieces(find(kSamplers, sampler), pieces_per_side);
  }
  WorkingMemory loop;
  for (const MethodChoice& filter : filters)
    loop = larger(loop, find(kFilters, filter));
  const WorkingMemory own = find(kSamplers, MethodChoice{"uniform", {}, {}});
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
  filtering.per_pixel += kJudging;
  return larger(most, filtering);
}

}  // namespace spool::tools
