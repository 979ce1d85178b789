#include "tools/pack.h"

#include <nlohmann/json.hpp>

namespace spool::tools {

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common) {
  format::PackOptions pack = options.pack;
  pack.force = common.force;
  SPOOL_ASSIGN(const format::PackReport report,
               format::pack_passes(options.folders, options.output, pack));
  if (common.json) {
    const nlohmann::ordered_json out = {{"file", options.output.string()},
                                        {"width", report.width},
                                        {"height", report.height},
                                        {"samples_per_pixel", report.spp},
                                        {"reference_samples_per_pixel", report.reference_spp},
                                        {"cost_per_sample", report.cost_per_sample},
                                        {"layers", report.layers},
                                        {"bytes", report.bytes}};
    print(out.dump(2) + "\n");
  } else if (!common.quiet) {
    print(fmt::format(
        "{}: {} x {} pixels, {} samples each, {}{}\n", options.output.string(), report.width,
        report.height, report.spp, format_bytes(static_cast<double>(report.bytes)),
        report.reference_spp > 0 ? fmt::format(", reference of {} samples", report.reference_spp)
                                 : ", no reference"));
  }
  return {};
}

}  // namespace spool::tools
