#include "lib/methods/method_text.h"

#include <algorithm>
#include <array>

namespace spool {
namespace {

// ",a=1,b=2"
std::string settings_of(const OptionValues& set) {
  std::string text;
  for (const auto& [name, value] : set)
    text += fmt::format(",{}={}", name, value);
  return text;
}

std::string in_full(const MethodChoice& choice) {
  std::string set = settings_of(choice.set);
  if (!set.empty()) set = "{" + set.substr(1) + "}";
  const std::string preset = choice.preset.empty() ? "" : ":" + choice.preset;
  return choice.name + (choice.has_argument ? set + preset : preset + set);
}

// Of "a=1,b=2".
Result<OptionValues> parse_settings(std::string_view method, std::string_view inside) {
  OptionValues set;
  while (!inside.empty()) {
    const std::string_view part = inside.substr(0, inside.find(','));
    inside.remove_prefix(std::min(inside.size(), part.size() + 1));
    if (part.empty()) continue;
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0)
      return fail(ErrorCode::kUsage, "{}: '{}' is no OPTION=VALUE", method, part);
    set.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return set;
}

bool fits_label(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
         c == '_' || c == '-';
}

// Programs that run the script after them.
bool runs_another(std::string_view program) {
  constexpr std::array kNames = {"env",  "nice",    "time",  "sh",   "bash", "perl",
                                 "ruby", "Rscript", "julia", "node", "lua",  "octave"};
  return program.starts_with("python") || std::ranges::find(kNames, program) != kNames.end();
}

std::string_view file_name(std::string_view word) {
  return word.substr(word.find_last_of('/') + 1);
}

}  // namespace

std::string command_name(std::string_view command) {
  constexpr std::size_t kLongest = 32;
  std::string_view found;
  while (!command.empty()) {
    const std::string_view word = command.substr(0, command.find_first_of(" \t\n"));
    command.remove_prefix(std::min(command.size(), word.size() + 1));
    const bool is_name = !word.empty() && !word.starts_with('-') &&
                         word.find_first_of("={") == std::string_view::npos &&
                         word.find_first_not_of("0123456789") != std::string_view::npos;
    if (!is_name) continue;
    found = file_name(word);
    if (!runs_another(found)) break;
  }
  std::string name;
  for (const char c : found.substr(0, found.find_last_of('.'))) {
    if (fits_label(c) && name.size() < kLongest) name += c;
  }
  name.erase(0, std::min(name.size(), name.find_first_not_of(".-")));
  return name.empty() ? "command" : name;
}

std::string MethodChoice::label() const {
  return own_label.empty() ? in_full(*this) : own_label;
}

std::string MethodChoice::text() const {
  return own_label.empty() ? in_full(*this) : own_label + "=" + in_full(*this);
}

Result<void> check_label(const MethodChoice& choice) {
  constexpr std::size_t kLongest = 64;
  const std::string_view label = choice.own_label;
  const std::string_view word = label.substr(0, label.find('{'));
  if (word.empty() || word.size() > kLongest || !std::ranges::all_of(word, fits_label) ||
      word.starts_with('.') || word.starts_with('-')) {
    return fail(ErrorCode::kUsage,
                "label '{}': write 1 to {} letters, digits, '.', '_' or '-', a letter or digit "
                "first: it names files too",
                label, kLongest);
  }
  if (word.size() == label.size()) return {};
  std::string_view swept = label.substr(word.size() + 1);
  if (swept.ends_with('}')) swept.remove_suffix(1);
  const std::string chosen = fmt::format(",preset={}{}", choice.preset, settings_of(choice.set));
  while (!swept.empty()) {
    const std::string_view part = swept.substr(0, swept.find(','));
    swept.remove_prefix(std::min(swept.size(), part.size() + 1));
    if ((chosen + ",").find(fmt::format(",{},", part)) == std::string::npos) {
      return fail(ErrorCode::kUsage, "label '{}': '{}' was not chosen: leave the braces out", label,
                  part);
    }
  }
  return {};
}

Result<void> check_distinct(std::string_view kind, const std::vector<MethodChoice>& choices) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (choices[i].label() != choices[j].label()) continue;
      return fail(ErrorCode::kUsage, "{} {} is there twice: {} and {}: give one another label",
                  kind, choices[i].label(), choices[j].text(), choices[i].text());
    }
  }
  return {};
}

Result<MethodChoice> parse_method(std::string_view text,
                                  const std::vector<std::string>& takes_argument) {
  MethodChoice choice;
  std::string_view rest = text;
  if (const std::size_t end = rest.find_first_of("=:{"); end < rest.size() && rest[end] == '=') {
    choice.own_label = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    SPOOL_TRY(check_label(choice));
  }
  choice.name = rest.substr(0, rest.find_first_of(":{"));
  rest.remove_prefix(choice.name.size());
  choice.has_argument = std::ranges::find(takes_argument, choice.name) != takes_argument.end();
  if (choice.has_argument) {
    const std::size_t end = rest.starts_with('{') ? rest.find("}:") : std::string_view::npos;
    const std::size_t colon = end < rest.size() ? end + 1 : rest.starts_with(':') ? 0 : rest.size();
    choice.preset = rest.substr(std::min(colon + 1, rest.size()));
    rest = rest.substr(0, colon);
  }
  if (const std::size_t brace = rest.find('{'); brace != std::string_view::npos) {
    if (!rest.ends_with('}')) {
      return fail(ErrorCode::kUsage, "{}: the brace is not closed: write {}{{OPTION=VALUE}}{}",
                  text, choice.name, choice.has_argument ? ":..." : "");
    }
    SPOOL_ASSIGN(choice.set, parse_settings(text, rest.substr(brace + 1, rest.size() - brace - 2)));
    rest = rest.substr(0, brace);
  }
  if (!rest.empty()) choice.preset = rest.substr(1);
  return choice;
}

std::vector<std::string> split_methods(std::string_view text) {
  std::vector<std::string> methods(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '{') {
      ++depth;
    } else if (c == '}') {
      --depth;
    } else if (c == ',' && depth <= 0) {
      methods.emplace_back();
      continue;
    }
    methods.back() += c;
  }
  std::erase_if(methods, [](const std::string& method) { return method.empty(); });
  return methods;
}

}  // namespace spool
