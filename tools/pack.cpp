#include "tools/pack.h"

#include <map>

#include <nlohmann/json.hpp>

#include "formats/interchange/bcd_raw.h"
#include "formats/interchange/noisebase.h"
#include "formats/interchange/npz.h"
#include "formats/interchange/sbmc.h"
#include "lib/exchange/deep_exr.h"
#include "lib/exchange/exr_folder.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

std::string first_line(const PackVerbOptions& options, unsigned width, unsigned height,
                       unsigned spp) {
  return fmt::format("{}: {} x {} pixels, {} samples each", options.output.string(), width, height,
                     spp);
}

using interchange::ImportReport;

// What every importer is told.
template <class Options>
Options import_options(const PackVerbOptions& options, const CommonOptions& common) {
  Options import;
  import.compress = options.pack.compress;
  import.force = common.force;
  import.expansion.times = options.max_expansion;
  if (options.exchangeable) import.sample_order = format::SampleOrder::kExchangeable;
  return import;
}

using Importer = Result<ImportReport> (*)(const PackVerbOptions&, const CommonOptions&);

Result<ImportReport> from_npz(const PackVerbOptions& options, const CommonOptions& common) {
  auto import = import_options<interchange::NpzImportOptions>(options, common);
  import.narrow = options.narrow;
  if (options.layout == "HWSC") import.layout = interchange::NpzLayout::kHWSC;
  if (options.layout == "SHWC") import.layout = interchange::NpzLayout::kSHWC;
  return interchange::import_npz(options.sources[0], options.output, import);
}

Result<ImportReport> from_bcd(const PackVerbOptions& options, const CommonOptions& common) {
  return interchange::import_bcd_raw(options.sources[0], options.output,
                                     import_options<interchange::ImportOptions>(options, common));
}

Result<ImportReport> from_sbmc(const PackVerbOptions& options, const CommonOptions& common) {
  auto import = import_options<interchange::SbmcImportOptions>(options, common);
  if (options.sbmc_scale == "normalised") import.scale = interchange::SbmcScale::kNormalised;
  if (options.sbmc_scale == "raw") import.scale = interchange::SbmcScale::kRaw;
  return interchange::import_sbmc(options.sources[0], options.output, import);
}

Result<ImportReport> from_noisebase(const PackVerbOptions& options, const CommonOptions& common) {
  auto import = import_options<interchange::NoisebaseImportOptions>(options, common);
  import.frame = options.frame;
  return interchange::import_noisebase(options.sources[0], options.output, import);
}

Result<ImportReport> from_exr_folder(const PackVerbOptions& options, const CommonOptions& common) {
  auto import = import_options<exchange::ExrFolderImportOptions>(options, common);
  for (const std::string& entry : options.layer_map) {
    const size_t equals = entry.find('=');
    if (equals == std::string::npos)
      return fail(ErrorCode::kUsage, "--map {}: give OURS=LAYER, e.g. albedo=DiffCol", entry);
    import.map[entry.substr(0, equals)] = entry.substr(equals + 1);
  }
  return exchange::import_exr_folder(options.sources[0], options.output, import);
}

Result<ImportReport> from_deep_exr(const PackVerbOptions& options, const CommonOptions& common) {
  auto import = import_options<exchange::DeepImportOptions>(options, common);
  import.foreign_samples = options.deep_samples;
  return exchange::import_deep_exr(options.sources[0], options.output, import);
}

const std::map<std::string, Importer>& importers() {
  static const std::map<std::string, Importer> doors = {{"npz", from_npz},
                                                        {"bcd", from_bcd},
                                                        {"sbmc", from_sbmc},
                                                        {"noisebase", from_noisebase},
                                                        {"exr-folder", from_exr_folder},
                                                        {"deep-exr", from_deep_exr}};
  return doors;
}

Result<void> pack_foreign(Importer importer, const PackVerbOptions& options,
                          const CommonOptions& common) {
  if (options.sources.size() != 1) {
    return fail(ErrorCode::kUsage, "--from {}: give one source, not {}", options.from,
                options.sources.size());
  }
  SPOOL_ASSIGN(const ImportReport report, importer(options, common));
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

const std::vector<std::string>& foreign_formats() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> keys;
    for (const auto& [name, importer] : importers())
      keys.push_back(name);
    return keys;
  }();
  return names;
}

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common) {
  const auto door = importers().find(options.from);
  return door == importers().end() ? pack_folders(options, common)
                                   : pack_foreign(door->second, options, common);
}

}  // namespace spool::tools
