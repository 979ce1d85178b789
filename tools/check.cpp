#include "tools/check.h"

#include <nlohmann/json.hpp>

#include "formats/dump_check.h"

namespace spool::tools {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string describe(const format::BlockKey& block) {
  return fmt::format("group {}, tile {}, samples {} .. {}", block.group, block.tile,
                     block.sample_begin, block.sample_begin + block.sample_count - 1);
}

ordered_json json_of(const format::BlockKey& block) {
  return {{"group", block.group},
          {"tile", block.tile},
          {"sample_begin", block.sample_begin},
          {"sample_count", block.sample_count}};
}

void print_json(const std::string& name, const format::CheckReport& report) {
  ordered_json out = {{"file", name},
                      {"complete", report.complete},
                      {"opens", report.opens},
                      {"records", report.records},
                      {"bytes", report.bytes},
                      {"damaged", json::array()},
                      {"missing", json::array()}};
  for (const format::DamagedRecord& record : report.damaged) {
    ordered_json entry = {
        {"type", record.type}, {"offset", record.offset}, {"reason", record.reason}};
    if (record.block) entry["block"] = json_of(*record.block);
    out["damaged"].push_back(entry);
  }
  for (const format::BlockKey& block : report.missing)
    out["missing"].push_back(json_of(block));
  print(out.dump(2) + "\n");
}

void print_text(const std::string& name, const format::CheckReport& report) {
  for (const format::DamagedRecord& record : report.damaged) {
    print(fmt::format("damaged  byte {}  {}  {}{}\n", record.offset, record.type, record.reason,
                      record.block ? "  (" + describe(*record.block) + ")" : ""));
  }
  for (const format::BlockKey& block : report.missing) {
    print(fmt::format("missing  {}\n", describe(block)));
  }
  if (report.complete) {
    print(fmt::format("{}: whole: {} records, {}, every byte verified\n", name, report.records,
                      format_bytes(static_cast<double>(report.bytes))));
  }
}

}  // namespace

Result<void> run_check(const CheckOptions& options, const CommonOptions& common) {
  const std::string name = options.dump.string();
  SPOOL_ASSIGN(const format::CheckReport report, format::check_dump(options.dump));
  if (common.json) {
    print_json(name, report);
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
