// What the program's verbs and options are, as plain text: read from the parser by main.cpp, made
// into shell completions and manual pages.
#pragma once

#include <string>
#include <vector>

namespace spool::tools {

struct OptionText {
  std::vector<std::string> names;  // "-o", "--output"; of an argument by its place: "FILE"
  std::string value;               // "TEXT"; empty: a switch, or an argument by its place
  std::string help;
  std::vector<std::string> choices;  // all values there are; empty: any, perhaps a file's name
  bool required = false;
  bool several = false;  // may be given more than once, or takes more than one word
};

struct VerbText {
  std::string name;
  std::string summary;
  std::string notes;                  // with "Examples:" on a line of its own, then the examples
  std::vector<OptionText> arguments;  // by their place
  std::vector<OptionText> options;
};

struct ProgramText {
  std::string name;
  std::string version;
  std::string summary;
  std::string notes;
  std::vector<VerbText> verbs;
};

}  // namespace spool::tools
