// A finished cell as JSON text: its columns, how many samples its pixels took, and the differences
// of its halves.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/experiment/result_record.h"

namespace spool::tools {

std::string cell_text(const ResultRecord& record);

// Fills in all but the columns that say which cell it is; false when the text is no cell's. No tree
// of values is made: a merge reads millions.
bool read_cell_text(std::string_view text, ResultRecord& record);

// "2:4000 5:96": samples taken, and the number of pieces that gave so many. What is no such text
// counts as not known.
std::vector<std::pair<int, long long>> counts_of(std::string_view text);

// Numbers between spaces, e.g. of one half's difference in each cell of the image; `columns` of
// them in a row. What is no such text counts as not measured.
bool read_halves(long long columns, std::string_view cells, std::string_view varying,
                 HalfDifference& difference);

}  // namespace spool::tools
