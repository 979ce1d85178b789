#include "tools/verbs/convert.h"

#include "lib/exchange/foreign_formats.h"
#include "tools/json/answers_json.h"
#include "tools/verbs/foreign_settings.h"

namespace spool::tools {

Result<void> run_convert(const ConvertOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const OptionValues set,
               foreign_settings("export", options.settings, "names=blender"));
  for (const interchange::ExportFormat& format : exchange::export_formats()) {
    if (format.name != options.to) continue;
    SPOOL_ASSIGN(const interchange::ExportReport report,
                 format.write(options.input, options.output, {.force = common.force}, set));
    if (common.json) {
      print(export_text(options.output, options.to, report));
    } else if (!common.quiet) {
      print_line(options.output.string());
      for (const std::string& note : report.notes)
        print_line(note);
    }
    return {};
  }
  return fail(ErrorCode::kUsage, "{}",
              unknown_name("format", options.to, names_of(exchange::export_formats()),
                           ": see spool list exports"));
}

}  // namespace spool::tools
