#include "lib/experiment/toml_nesting.h"

#include <algorithm>
#include <string>

namespace spool {
namespace {

// Where the string that begins at text[at] ends; one past its last quotation mark. A string that
// its line or the text does not end is an error of TOML and ends there. Up to two marks more may
// stand before the three that end a string of several lines (TOML 1.0).
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool several_lines = text.substr(at, 3) == std::string(3, quote);
  const std::size_t marks = several_lines ? 3 : 1, more = several_lines ? 2 : 0;
  for (std::size_t i = at + marks; i < text.size(); ++i) {
    if (text[i] == '\n' && !several_lines) return i;
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (text.substr(i, marks) == text.substr(at, marks)) {
      std::size_t end = i + marks;
      while (end < std::min(text.size(), i + marks + more) && text[end] == quote)
        ++end;
      return end;
    }
  }
  return text.size();
}

}  // namespace

std::size_t line_nested_too_deeply(std::string_view text, std::size_t limit) {
  std::size_t line = 1, brackets = 0, dots = 0;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(text, i);
      line += static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                                  text.begin() + static_cast<std::ptrdiff_t>(end),
                                                  '\n'));
      i = end;
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '.') {
      if (++dots > limit) return line;
    } else if (c == '[' || c == '{') {
      if (++brackets > limit) return line;
    } else if (c == ']' || c == '}') {
      brackets -= brackets > 0 ? 1 : 0;
    }
    if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') dots = 0;
    line += c == '\n' ? 1 : 0;
    ++i;
  }
  return 0;
}

}  // namespace spool
