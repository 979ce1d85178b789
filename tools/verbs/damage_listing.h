// Damaged records and lost blocks as text and as JSON, for `spool check` and `spool recover`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "formats/dump_check.h"

namespace spool::tools {

std::string describe_block(const format::BlockKey& block);  // "group 0, tile 3, samples 0 .. 15"
std::string describe_record(const format::DamagedRecord& record);  // one line

nlohmann::ordered_json json_of_block(const format::BlockKey& block);
nlohmann::ordered_json json_of_record(const format::DamagedRecord& record);

}  // namespace spool::tools
