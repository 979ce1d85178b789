#include "tools/json/json_text.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "lib/core/visible_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

std::string valid(const std::string& text) {
  return is_utf8(text) ? text : visible_text(text);
}

ordered_json with_valid_strings(const ordered_json& value) {
  if (value.is_string()) return valid(value.get_ref<const std::string&>());
  if (!value.is_structured()) return value;
  ordered_json copy = value.is_array() ? ordered_json::array() : ordered_json::object();
  for (const auto& [key, item] : value.items()) {
    if (value.is_array()) {
      copy.push_back(with_valid_strings(item));
    } else {
      copy[valid(key)] = with_valid_strings(item);
    }
  }
  return copy;
}

}  // namespace

std::string json_text(const ordered_json& value) {
  return with_valid_strings(value).dump(2) + "\n";
}

ordered_json json_number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

}  // namespace spool::tools
