#include "lib/methods/method_text.h"

#include <algorithm>

namespace spool {
namespace {

std::string in_full(const MethodChoice& choice) {
  std::string text = choice.name;
  if (!choice.preset.empty()) text += ":" + choice.preset;
  if (choice.set.empty()) return text;
  text += "{";
  for (std::size_t i = 0; i < choice.set.size(); ++i) {
    if (i > 0) text += ',';
    text += choice.set[i].first + "=" + choice.set[i].second;
  }
  return text + "}";
}

}  // namespace

std::string MethodChoice::label() const {
  return own_label.empty() ? in_full(*this) : own_label;
}

std::string MethodChoice::text() const {
  return own_label.empty() ? in_full(*this) : own_label + "=" + in_full(*this);
}

Result<MethodChoice> parse_method(std::string_view text,
                                  const std::vector<std::string>& takes_argument) {
  MethodChoice choice;
  choice.name = text.substr(0, text.find_first_of(":{"));
  std::string_view rest = text.substr(choice.name.size());
  if (std::ranges::find(takes_argument, choice.name) != takes_argument.end()) {
    if (rest.starts_with(':')) choice.preset = rest.substr(1);
    return choice;
  }
  if (const std::size_t brace = rest.find('{'); brace != std::string_view::npos) {
    if (!rest.ends_with('}')) {
      return fail(ErrorCode::kUsage, "{}: the brace is not closed: write {}{{OPTION=VALUE}}", text,
                  choice.name);
    }
    std::string_view inside = rest.substr(brace + 1, rest.size() - brace - 2);
    while (!inside.empty()) {
      const std::string_view part = inside.substr(0, inside.find(','));
      inside.remove_prefix(std::min(inside.size(), part.size() + 1));
      if (part.empty()) continue;
      const std::size_t equals = part.find('=');
      if (equals == std::string_view::npos || equals == 0) {
        return fail(ErrorCode::kUsage, "{}: '{}' is no OPTION=VALUE", text, part);
      }
      choice.set.emplace_back(part.substr(0, equals), part.substr(equals + 1));
    }
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
