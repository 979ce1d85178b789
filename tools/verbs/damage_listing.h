// Damaged records and lost blocks as text, for `spool check` and `spool recover`.
#pragma once

#include <string>

namespace spool::tools {

std::string describe_block(const format::BlockKey& block);  // "group 0, tile 3, samples 0 .. 15"
std::string describe_record(const format::DamagedRecord& record);  // one line

}  // namespace spool::tools
