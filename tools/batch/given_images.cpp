#include "tools/batch/given_images.h"

#include <filesystem>
#include <set>

#include "tools/methods/external_methods.h"
#include "tools/methods/replicate_images.h"

namespace spool::tools {
namespace {

// The filter that a sampler has in its loop cannot be a file.
Result<void> refuse_loops(const Plan& plan, const std::string& of) {
  for (const MethodChoice& sampler : plan.samplers) {
    SPOOL_ASSIGN(const ReadySampler ready, make_method(known_samplers(), sampler));
    if (!ready.needs.filter_in_loop || !ready.needs.loop_filter.empty()) continue;
    return fail(ErrorCode::kUsage,
                "{}: {} has the filter in its loop, and its samples depend on it: choose the "
                "loop's filter ({}{{filter=box}}) or another sampler",
                of, sampler.label(), sampler.name);
  }
  return {};
}

}  // namespace

Result<void> check_image_names(const Plan& plan, const std::string& pattern,
                               const std::string& of) {
  SPOOL_TRY(refuse_loops(plan, of));
  if (plan.experiment.decision_split || plan.experiment.reference == ReferenceKind::kCrossfit) {
    return fail(ErrorCode::kUsage,
                "{}: is one image of each replicate, and crossfit and split decisions need one of "
                "each half: leave them out",
                of);
  }
  std::set<std::string> names;
  for (const Cell& cell :
       all_cells(plan.recordings, plan.samplers, {MethodChoice{}}, plan.spp, plan.replicates)) {
    const std::string name = image_of(cell, pattern);
    if (names.insert(name).second) continue;
    return fail(
        ErrorCode::kUsage,
        "{}: two results would have the one image {}: name recordings and samplers apart, "
        "and write all of {{recording}}, {{sampler}}, {{spp}} and {{replicate}} that differ",
        of, name);
  }
  return {};
}

Result<void> check_given_images(const Plan& plan, const std::vector<Cell>& cells) {
  for (const MethodChoice& filter : plan.filters) {
    if (!is_of_replicates(filter)) continue;
    const std::string of = "image:" + filter.preset;
    SPOOL_TRY(check_image_names(plan, filter.preset, of));
    std::size_t wanted = 0, missing = 0;
    std::string first;
    for (const Cell& cell : cells) {
      if (cell.filter != filter) continue;
      ++wanted;
      const std::string name = image_of(cell, filter.preset);
      std::error_code status;
      if (std::filesystem::exists(name, status)) continue;
      if (missing++ == 0) first = name;
    }
    if (missing == 0) continue;
    return fail(ErrorCode::kIo,
                "{}: {} of {} images are missing, first {}: make each of the input of its name "
                "(spool evaluate --export-inputs DIR)",
                of, missing, wanted, first);
  }
  return {};
}

}  // namespace spool::tools
