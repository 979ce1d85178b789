// What every verb of the program shares: its switches and its output.
//
// Results go to stdout, errors (one line) and progress to stderr.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "tools/terminal/text_columns.h"

namespace spool::tools {

struct CommonOptions {
  bool json = false;
  bool force = false;
  bool quiet = false;
  int threads = 0;  // 0: all
};

// To stdout. Whatever text holds arrives as text (visible_text.h): print() lets line ends pass, so
// lines that hold text from files go through print_line(), which adds the one line end there is.
void print(std::string_view text);
void print_line(std::string_view text);
// kIo when something printed did not arrive (a full disk, a closed stdout).
Result<void> check_output();

// From now on print_note() prints nothing: --quiet of every verb.
void keep_quiet();
// To stderr, which may be closed or full: nothing is said of that.
void print_error(const Error& error);  // "spool: ...", one line, at most 400 bytes
void print_warning(std::string_view text);
void print_note(std::string_view text);       // nothing where `text` is empty
void print_raw_error(std::string_view text);  // with the control characters of a progress line

// What takes away the line of stderr that a progress is on; empty where nothing does: in a file, or
// on a terminal that obeys no control characters (TERM=dumb).
std::string_view line_eraser();

// Descriptors 0 to 2 lead somewhere from now on: a file that is opened must not become stderr.
void open_standard_streams();

std::string format_bytes(double bytes);      // "12.3 MB"
std::string format_seconds(double seconds);  // "0.42 s", "3 min 20 s"

// The parts of "a,b,c"; empty parts are dropped.
std::vector<std::string> split_list(std::string_view text);

}  // namespace spool::tools
