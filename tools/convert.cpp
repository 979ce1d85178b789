#include "tools/convert.h"

#include <charconv>
#include <map>

#include <nlohmann/json.hpp>

#include "formats/interchange/bcd_raw.h"
#include "formats/interchange/npz_export.h"
#include "lib/exchange/bcd_statistics.h"
#include "lib/exchange/deep_exr.h"
#include "lib/exchange/exr_folder_export.h"
#include "lib/exchange/oidn_set.h"
#include "tools/json_text.h"

namespace spool::tools {
namespace {

using interchange::ExportReport;
using Exporter = Result<ExportReport> (*)(const ConvertOptions&, const CommonOptions&);

Result<std::vector<uint32_t>> counts_of(const ConvertOptions& options) {
  std::vector<uint32_t> counts;
  for (const std::string& list : options.spp) {
    for (const std::string& text : split_list(list)) {
      uint32_t count = 0;
      const auto parsed = std::from_chars(text.data(), text.data() + text.size(), count);
      if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || count == 0)
        return fail(ErrorCode::kUsage, "--spp {}: give counts of samples: 8,16", text);
      counts.push_back(count);
    }
  }
  return counts;
}

Result<ExportReport> to_npz(const ConvertOptions& options, const CommonOptions& common) {
  SPOOL_TRY(interchange::export_npz(options.input, options.output, {.force = common.force}));
  return ExportReport{};
}

Result<ExportReport> to_bcd(const ConvertOptions& options, const CommonOptions& common) {
  return interchange::export_bcd_raw(options.input, options.output, {.force = common.force});
}

Result<ExportReport> to_bcd_statistics(const ConvertOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const auto counts, counts_of(options));
  if (counts.size() > 1 || (!counts.empty() && !options.selection.empty()))
    return fail(ErrorCode::kUsage, "--to bcd-stats takes one --spp or a --selection");
  exchange::BcdStatisticsOptions statistics;
  statistics.force = common.force;
  if (!counts.empty()) statistics.spp = counts[0];
  if (!options.selection.empty()) statistics.selection = options.selection;
  return exchange::export_bcd_statistics(options.input, options.output, statistics);
}

Result<ExportReport> to_exr_folder(const ConvertOptions& options, const CommonOptions& common) {
  const auto names = options.names == "blender" ? exchange::ExrNames::kBlender
                     : options.names == "rgb"   ? exchange::ExrNames::kRgb
                                                : exchange::ExrNames::kPlain;
  return exchange::export_exr_folder(options.input, options.output, names, common.force);
}

Result<ExportReport> to_deep_exr(const ConvertOptions& options, const CommonOptions& common) {
  return exchange::export_deep_exr(options.input, options.output, common.force);
}

Result<ExportReport> to_oidn(const ConvertOptions& options, const CommonOptions& common) {
  exchange::OidnSetOptions set;
  SPOOL_ASSIGN(set.spp, counts_of(options));
  set.name = options.name;
  set.force = common.force;
  return exchange::export_oidn_set(options.input, options.output, set);
}

const std::map<std::string, Exporter>& exporters() {
  static const std::map<std::string, Exporter> doors = {{"npz", to_npz},
                                                        {"bcd", to_bcd},
                                                        {"bcd-stats", to_bcd_statistics},
                                                        {"exr-folder", to_exr_folder},
                                                        {"deep-exr", to_deep_exr},
                                                        {"oidn", to_oidn}};
  return doors;
}

}  // namespace

const std::vector<std::string>& target_formats() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> keys;
    for (const auto& [name, exporter] : exporters())
      keys.push_back(name);
    return keys;
  }();
  return names;
}

Result<void> run_convert(const ConvertOptions& options, const CommonOptions& common) {
  const auto door = exporters().find(options.to);
  if (door == exporters().end())
    return fail(ErrorCode::kUsage, "--to {}: one of {} is possible", options.to,
                fmt::join(target_formats(), ", "));
  SPOOL_ASSIGN(const ExportReport report, door->second(options, common));
  if (common.json) {
    const nlohmann::ordered_json out = {
        {"output", options.output.string()}, {"format", options.to}, {"notes", report.notes}};
    print(json_text(out));
  } else if (!common.quiet) {
    print_line(options.output.string());
    for (const std::string& note : report.notes)
      print_line(note);
  }
  return {};
}

}  // namespace spool::tools
