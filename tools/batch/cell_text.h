// A finished cell as JSON text: its columns, how many samples its pixels took, and the differences
// of its halves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lib/experiment/result_record.h"

namespace spool::tools {

// As a line of JSON, without its end:
// {"crc32":"1a2b3c4d","cell":"0123456789abcdef","failed":0,"method":"uniform + box",...}, the
// method for people. The checksum is that of all behind it, from "cell" on.
std::string cell_line(std::uint64_t number, const ResultRecord& record);

struct CheckedLine {
  std::uint64_t number = 0;  // cell_id() of it is the cell's
  bool failed = false;
};
// Nothing when its checksum is another.
std::optional<CheckedLine> checked_line(std::string_view line);

// Of a cell, or of a line that has the fields itself; false when it has no field. No tree of values
// is made: a merge reads millions.
bool read_cell_text(std::string_view text, ResultRecord& record);

}  // namespace spool::tools
