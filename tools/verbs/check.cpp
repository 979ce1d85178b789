#include "tools/verbs/check.h"

#include "formats/dump_check.h"
#include "formats/spool_recovery.h"
#include "lib/core/counted.h"
#include "tools/json/answers_json.h"

namespace spool::tools {
namespace {

std::string describe_block(const format::BlockKey& block) {
  return fmt::format("group {}, tile {}, samples {} .. {}", block.group, block.tile,
                     block.sample_begin, block.sample_begin + block.sample_count - 1);
}

std::string describe_record(const format::DamagedRecord& record) {
  return fmt::format("damaged  byte {}  {}  {}{}", record.offset, record.type, record.reason,
                     record.block ? "  (" + describe_block(*record.block) + ")" : "");
}

void print_text(const std::string& name, const format::CheckReport& report) {
  for (const auto& record : report.damaged)
    print_line(describe_record(record));
  for (const auto& block : report.missing)
    print_line("missing  " + describe_block(block));
  if (report.complete) {
    print_line(fmt::format("{}: whole: {}, {}, every byte verified", name,
                           counted(report.records, "record"),
                           format_bytes(static_cast<double>(report.bytes))));
  }
}

// What a cut took away leaves no trace in the file: those blocks are known from the geometry alone.
std::string balance(const format::RecoveryReport& report) {
  std::string text = fmt::format(
      "{} of {} kept, {}", report.kept_blocks,
      counted(report.kept_blocks + report.lost.size() + report.absent.size(), "block"),
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
  print_line(fmt::format("{}: {}", options.output.string(),
                         report.anything_lost() || !report.absent.empty()
                             ? balance(report)
                             : counted(report.kept_blocks, "block") + " kept, nothing was lost"));
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
    return fail(ErrorCode::kDamage, "{}: {} never recorded: the rest is intact", name,
                counted(report.missing.size(), "block was", "blocks were"));
  }
  return fail(
      ErrorCode::kDamage, "{}: {}, {} lost{}", name,
      counted(report.damaged.size(), "damaged place"), counted(report.missing.size(), "block"),
      report.damaged.empty() ? std::string()
                             : fmt::format(" (first at byte {})", report.damaged.front().offset));
}

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
