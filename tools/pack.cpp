#include "tools/pack.h"

#include <nlohmann/json.hpp>

#include "formats/interchange/npz.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

std::string first_line(const PackVerbOptions& options, unsigned width, unsigned height,
                       unsigned spp) {
  return fmt::format("{}: {} x {} pixels, {} samples each", options.output.string(), width, height,
                     spp);
}

Result<void> pack_npz(const PackVerbOptions& options, const CommonOptions& common) {
  if (options.sources.size() != 1) {
    return fail(ErrorCode::kUsage, "--from npz: give one file, not {}", options.sources.size());
  }
  interchange::NpzImportOptions import;
  import.compress = options.pack.compress;
  import.force = common.force;
  import.narrow = options.narrow;
  if (options.layout == "HWSC") import.layout = interchange::NpzLayout::kHWSC;
  if (options.layout == "SHWC") import.layout = interchange::NpzLayout::kSHWC;
  SPOOL_ASSIGN(const interchange::ImportReport report,
               interchange::import_npz(options.sources.front(), options.output, import));
  if (common.json) {
    const ordered_json out = {{"file", options.output.string()}, {"width", report.width},
                              {"height", report.height},         {"samples_per_pixel", report.spp},
                              {"layers", report.layers},         {"notes", report.notes}};
    print(out.dump(2) + "\n");
  } else if (!common.quiet) {
    print(first_line(options, report.width, report.height, report.spp) + "\n");
    for (const std::string& note : report.notes)
      print(note + "\n");
  }
  return {};
}

Result<void> pack_folders(const PackVerbOptions& options, const CommonOptions& common) {
  format::PackOptions pack = options.pack;
  pack.force = common.force;
  SPOOL_ASSIGN(const format::PackReport report,
               format::pack_passes(options.sources, options.output, pack));
  if (common.json) {
    const ordered_json out = {{"file", options.output.string()},
                              {"width", report.width},
                              {"height", report.height},
                              {"samples_per_pixel", report.spp},
                              {"reference_samples_per_pixel", report.reference_spp},
                              {"cost_per_sample", report.cost_per_sample},
                              {"layers", report.layers},
                              {"bytes", report.bytes}};
    print(out.dump(2) + "\n");
  } else if (!common.quiet) {
    print(fmt::format("{}, {}, {}\n", first_line(options, report.width, report.height, report.spp),
                      format_bytes(static_cast<double>(report.bytes)),
                      report.reference_spp > 0
                          ? fmt::format("reference of {} samples", report.reference_spp)
                          : "no reference"));
  }
  return {};
}

}  // namespace

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common) {
  return options.from == "npz" ? pack_npz(options, common) : pack_folders(options, common);
}

}  // namespace spool::tools
