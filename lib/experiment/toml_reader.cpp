#include "lib/experiment/toml_reader.h"

#include <cstdint>

#include "lib/core/option_table.h"
#include "lib/core/percent_text.h"

namespace spool {

std::vector<const toml::node*> values_of(const toml::node& node) {
  std::vector<const toml::node*> values;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& value : *list)
      values.push_back(&value);
  } else {
    values.push_back(&node);
  }
  return values;
}

std::string file_of_text(const std::string& text) {
  constexpr std::string_view kScheme = "file:";
  if (!text.starts_with(kScheme)) return text;
  return percent_decoded(std::string_view(text).substr(kScheme.size()));
}

Result<std::string> TomlReader::text_of(const toml::node& node) const {
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto whole = node.value_exact<std::int64_t>()) return std::to_string(*whole);
  if (const auto number = node.value_exact<double>()) return format_number(*number);
  if (const auto flag = node.value_exact<bool>()) return std::string(*flag ? "on" : "off");
  return refuse(node, "a number, a text or true/false is wanted here");
}

}  // namespace spool
