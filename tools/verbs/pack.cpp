#include "tools/verbs/pack.h"

#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/exchange/foreign_formats.h"
#include "tools/json/answers_json.h"
#include "tools/terminal/interrupt.h"
#include "tools/verbs/foreign_settings.h"

namespace spool::tools {
namespace {

std::string first_line(const PackVerbOptions& options, unsigned width, unsigned height,
                       unsigned spp) {
  return fmt::format("{}: {} x {} pixels, {} each", options.output.string(), width, height,
                     counted(spp, "sample"));
}

using interchange::ImportReport;

Result<void> pack_foreign(const interchange::ImportFormat& format, const PackVerbOptions& options,
                          const CommonOptions& common) {
  if (options.sources.size() != 1) {
    return fail(ErrorCode::kUsage, "--from {}: give one source, not {}", options.from,
                options.sources.size());
  }
  for (const auto& [given, name] : {std::pair{options.pack.radiance_f16, "--half-radiance"},
                                    std::pair{options.pack.features_f32, "--full-features"}}) {
    if (!given) continue;
    return fail(
        ErrorCode::kUsage,
        "{}: is for folders of passes; --from {} keeps the types of its source: leave it out, "
        "or save the source in that type",
        name, options.from);
  }
  if (options.pack.remove_passes) {
    return fail(ErrorCode::kUsage, "--remove-passes: is for folders of passes: leave it out");
  }
  SPOOL_ASSIGN(OptionValues set, foreign_settings("import", options.settings, "layout=HWSC"));
  for (const auto& [name, value] :
       {std::pair{"layer", options.layer.layer}, std::pair{"part", options.layer.part}})
    if (!value.empty()) set.emplace_back(name, value);
  interchange::ImportOptions import;
  import.compress = options.pack.compress;
  import.force = common.force;
  import.expansion.times = options.max_expansion;
  SPOOL_ASSIGN(const ImportReport report,
               format.import(options.sources[0], options.output, import, set));
  if (common.json) {
    print(import_text(options.output, report));
  } else if (!common.quiet) {
    print_line(first_line(options, report.width, report.height, report.spp));
    for (const std::string& note : report.notes)
      print_line(note);
  }
  return {};
}

Result<void> pack_folders(const PackVerbOptions& options, const CommonOptions& common) {
  std::error_code ignored;
  for (const auto& source : options.sources)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source, ignored))
      SPOOL_TRY(format::refuse_own_input(options.output, entry.path()));
  format::PackOptions pack = options.pack;
  pack.force = common.force;
  pack.max_expansion = options.max_expansion;
  SPOOL_ASSIGN(const format::PackReport report,
               format::pack_passes(options.sources, options.output, pack));
  if (common.json) {
    print(pack_text(options.output, report));
  } else if (!common.quiet) {
    print_line(fmt::format(
        "{}, {}, {}", first_line(options, report.width, report.height, report.spp),
        format_bytes(static_cast<double>(report.bytes)),
        report.reference_spp > 0 ? "reference of " + counted(report.reference_spp, "sample")
                                 : "no reference"));
    if (!report.remark.empty()) print_line(report.remark);
  }
  return {};
}

}  // namespace

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common) {
  const InterruptNote note([&] {
    return options.pack.remove_passes
               ? "what was packed is kept beside " + options.output.string() + ": see spool recover"
               : "nothing is kept of " + options.output.string() + ": the same command starts anew";
  });
  for (const interchange::ImportFormat& format : exchange::import_formats()) {
    if (format.name == options.from) return pack_foreign(format, options, common);
  }
  if (!options.layer.layer.empty() || !options.layer.part.empty()) {
    return fail(ErrorCode::kUsage, "--layer, --part: folders of passes have none: name a --from");
  }
  if (!options.settings.empty()) {
    return fail(ErrorCode::kUsage, "--set {}: folders of passes have no options: name a --from",
                options.settings[0]);
  }
  return pack_folders(options, common);
}

}  // namespace spool::tools
