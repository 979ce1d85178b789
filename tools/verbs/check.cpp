#include "tools/verbs/check.h"

#include "formats/dump_check.h"
#include "tools/json/answers_json.h"
#include "tools/verbs/damage_listing.h"

namespace spool::tools {
namespace {

void print_text(const std::string& name, const format::CheckReport& report) {
  for (const auto& record : report.damaged)
    print_line(describe_record(record));
  for (const auto& block : report.missing)
    print_line("missing  " + describe_block(block));
  if (report.complete) {
    print_line(fmt::format("{}: whole: {} records, {}, every byte verified", name, report.records,
                           format_bytes(static_cast<double>(report.bytes))));
  }
}

}  // namespace

Result<void> run_check(const CheckOptions& options, const CommonOptions& common) {
  const std::string name = options.dump.string();
  SPOOL_ASSIGN(const format::CheckReport report, format::check_dump(options.dump));
  if (common.json) {
    print(check_text(name, report));
  } else if (!common.quiet) {
    print_text(name, report);
  }
  if (report.complete) return {};
  if (report.intact()) {
    return fail(ErrorCode::kDamage, "{}: {} blocks were never recorded: the rest is intact", name,
                report.missing.size());
  }
  return fail(ErrorCode::kDamage, "{}: {} damaged places, {} blocks lost{}", name,
              report.damaged.size(), report.missing.size(),
              report.damaged.empty()
                  ? std::string()
                  : fmt::format(" (first at byte {})", report.damaged.front().offset));
}

}  // namespace spool::tools
