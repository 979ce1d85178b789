// What every verb of the program shares: its switches and how it speaks.
//
// Results go to stdout, errors (one line) and progress to stderr.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

struct CommonOptions {
  bool json = false;
  bool force = false;
  bool quiet = false;
  int threads = 0;  // 0: all
};

void print(std::string_view text);     // to stdout, as it is
void print_error(const Error& error);  // "spool: ..." to stderr
void print_warning(std::string_view text);

// Text in columns: the first row is the header; numbers (columns >= `first_number`) to the right.
std::string format_columns(const std::vector<std::vector<std::string>>& rows,
                           std::size_t first_number);

std::string format_bytes(double bytes);      // "12.3 MB"
std::string format_seconds(double seconds);  // "0.42 s", "3 min 20 s"

// The parts of "a,b,c"; empty parts are dropped.
std::vector<std::string> split_list(std::string_view text);

}  // namespace spool::tools
