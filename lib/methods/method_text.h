// How methods are written: on a command line, in a plan, and in every table.
//
//   NAME   NAME:PRESET   NAME{a=1,b=2}   NAME:PRESET{a=1,b=2}   LABEL=any of these
//   NAME:ARGUMENT   NAME{a=1,b=2}:ARGUMENT   of methods that take an argument, whatever it holds
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"

namespace spool {

// A method, its preset and its options, as they were chosen.
struct MethodChoice {
  std::string name;
  std::string preset;          // empty: the method's default; or the argument of methods with one
  OptionValues set;            // on top of the preset, in order
  std::string own_label = {};  // "ours"; empty: what is chosen, in full
  bool has_argument = false;   // its kind of method; its options are written before the argument

  // The name in every table: the own label, else as above.
  std::string label() const;
  // Its name as it is written on a command line, the own label too.
  std::string text() const;
  friend bool operator==(const MethodChoice&, const MethodChoice&) = default;
};

// Whether an own label names a method in every table, chart and file. Error kUsage where it does
// not: letters, digits, '.', '_' and '-' only, at most 64; what a sweep adds to it, "{a=1}", has
// to be what was chosen.
Result<void> check_label(const MethodChoice& choice);

// Error kUsage when two methods have one label.
Result<void> check_distinct(std::string_view kind, const std::vector<MethodChoice>& choices);

// What a command is called in a label: the stem of its script or program, "denoise" of
// "OMP_NUM_THREADS=1 python3 long/path/denoise.py --fast"; "command" where it has none.
std::string command_name(std::string_view command);

// `takes_argument`: the names of methods that take one.
Result<MethodChoice> parse_method(std::string_view text,
                                  const std::vector<std::string>& takes_argument);

// The parts of "a,b:paper,c{x=1,y=2}": commas in braces and in quotes do not part.
std::vector<std::string> split_methods(std::string_view text);

}  // namespace spool
