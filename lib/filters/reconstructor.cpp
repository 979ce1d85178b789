#include "lib/filters/reconstructor.h"

#include "lib/filters/box.h"
#include "lib/filters/cross_bilateral.h"
#include "lib/filters/directional/directional.h"
#include "lib/filters/gaussian.h"
#include "lib/filters/greedy_selection.h"
#include "lib/filters/multistage.h"
#include "lib/filters/nl_means.h"
#include "lib/filters/oracle_scale.h"
#include "lib/filters/wavelet_shrinkage.h"

namespace spool {

const std::vector<ReconstructorEntry>& reconstructors() {
  static const std::vector<ReconstructorEntry> list = {
      reconstructor_entry(box_method()),          reconstructor_entry(gaussian_method()),
      reconstructor_entry(directional_method()),  reconstructor_entry(greedy_selection_method()),
      reconstructor_entry(nl_means_method()),     reconstructor_entry(cross_bilateral_method()),
      reconstructor_entry(multistage_method()),   reconstructor_entry(wavelet_shrinkage_method()),
      reconstructor_entry(oracle_scale_method()),
  };
  return list;
}

Result<ReconstructorFunction> make_reconstructor(std::string_view name, std::string_view preset,
                                                 const OptionValues& set) {
  std::vector<std::string> names;
  for (const ReconstructorEntry& entry : reconstructors()) {
    if (entry.name == name) return entry.make(preset, set);
    names.push_back(entry.name);
  }
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::kUsage, "unknown filter '{}'{}", name,
              near.empty() ? std::string(": spool list filters names them all")
                           : fmt::format(": did you mean '{}'?", near));
}

}  // namespace spool
