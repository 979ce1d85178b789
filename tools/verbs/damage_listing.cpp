#include "tools/verbs/damage_listing.h"

#include <fmt/format.h>

namespace spool::tools {

std::string describe_block(const format::BlockKey& block) {
  return fmt::format("group {}, tile {}, samples {} .. {}", block.group, block.tile,
                     block.sample_begin, block.sample_begin + block.sample_count - 1);
}

std::string describe_record(const format::DamagedRecord& record) {
  return fmt::format("damaged  byte {}  {}  {}{}", record.offset, record.type, record.reason,
                     record.block ? "  (" + describe_block(*record.block) + ")" : "");
}

nlohmann::ordered_json json_of_block(const format::BlockKey& block) {
  return {{"group", block.group},
          {"tile", block.tile},
          {"sample_begin", block.sample_begin},
          {"sample_count", block.sample_count}};
}

nlohmann::ordered_json json_of_record(const format::DamagedRecord& record) {
  nlohmann::ordered_json entry = {
      {"type", record.type}, {"offset", record.offset}, {"reason", record.reason}};
  if (record.block) entry["block"] = json_of_block(*record.block);
  return entry;
}

}  // namespace spool::tools
