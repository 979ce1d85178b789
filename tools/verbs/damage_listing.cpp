#include "tools/verbs/damage_listing.h"

#include <fmt/core.h>

namespace spool::tools {

std::string describe_block(const format::BlockKey& block) {
  return fmt::format("group {}, tile {}, samples {} .. {}", block.group, block.tile,
                     block.sample_begin, block.sample_begin + block.sample_count - 1);
}

std::string describe_record(const format::DamagedRecord& record) {
  return fmt::format("damaged  byte {}  {}  {}{}", record.offset, record.type, record.reason,
                     record.block ? "  (" + describe_block(*record.block) + ")" : "");
}

}  // namespace spool::tools
