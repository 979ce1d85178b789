#include "tools/verbs/recover.h"

#include "formats/spool_recovery.h"
#include "tools/json/answers_json.h"
#include "tools/verbs/damage_listing.h"

namespace spool::tools {
namespace {

// What a cut took away leaves no trace in the file: those blocks are known from the geometry alone.
std::string balance(const format::RecoveryReport& report) {
  std::string text = fmt::format(
      "{} of {} blocks kept, {}", report.kept_blocks,
      report.kept_blocks + report.lost.size() + report.absent.size(),
      report.lost_records > 0 ? fmt::format("{} damaged", report.lost.size()) : "none damaged");
  if (!report.absent.empty()) {
    text += fmt::format(", {} not there: {}", report.absent.size(),
                        report.has_index ? "never recorded" : "cut off, or never recorded");
  }
  return text;
}

void print_text(const RecoverOptions& options, const format::RecoveryReport& report) {
  for (const auto& record : report.damaged)
    print_line(describe_record(record));
  for (const auto& block : report.lost)
    print_line("lost     " + describe_block(block));
  print_line(
      fmt::format("{}: {}", options.output.string(),
                  report.anything_lost() || !report.absent.empty()
                      ? balance(report)
                      : fmt::format("{} blocks kept, nothing was lost", report.kept_blocks)));
}

}  // namespace

Result<void> run_recover(const RecoverOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const format::RecoveryReport report,
               format::recover_dump(options.input, options.output, common.force));
  if (common.json) {
    print(recovery_text(options.input, options.output, report));
  } else if (!common.quiet) {
    print_text(options, report);
  }
  if (!report.anything_lost()) return {};
  return fail(ErrorCode::kDamage, "{}: {}; what was kept is whole", options.output.string(),
              balance(report));
}

}  // namespace spool::tools
