#include "tools/json/list_json.h"

#include <nlohmann/json.hpp>

#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

ordered_json options_json(const std::vector<ListedOption>& options, bool with_expert) {
  ordered_json list = ordered_json::array();
  for (const ListedOption& option : options) {
    list.push_back({{"name", option.name}, {"allowed", option.allowed}, {"help", option.help}});
    if (with_expert) list.back()["expert"] = option.expert;
    for (const auto& [preset, value] : option.defaults)
      list.back()["defaults"][preset] = value;
  }
  return list;
}

ordered_json readings_json(const std::vector<Reading>& readings) {
  ordered_json list = ordered_json::array();
  for (const Reading& reading : readings)
    list.push_back({{"name", reading.name}, {"of", reading.of}, {"summary", reading.summary}});
  return list;
}

}  // namespace

std::string methods_text(const ListedMethods& methods) {
  ordered_json list = ordered_json::array();
  for (const ListedMethod& method : methods) {
    list.push_back({{"name", method.name},
                    {"summary", method.summary},
                    {"argument", method.argument},
                    {"by_description", method.by_description},
                    {"needs", method.needs},
                    {"footprints", method.footprints},
                    {"presets", method.presets},
                    {"readings", readings_json(method.readings)},
                    {"options", options_json(method.options, true)}});
  }
  return json_text(list);
}

std::string formats_text(const ListedMethods& formats) {
  ordered_json list = ordered_json::array();
  for (const ListedMethod& format : formats) {
    list.push_back({{"name", format.name},
                    {"summary", format.summary},
                    {"options", options_json(format.options, false)}});
  }
  return json_text(list);
}

std::string options_text(const std::vector<ListedOption>& options) {
  return json_text(options_json(options, false));
}

std::string presets_text(const std::vector<ListedPreset>& presets) {
  ordered_json root = ordered_json::object();
  for (const ListedPreset& preset : presets) {
    if (!preset.samplers.empty()) root[preset.name]["samplers"] = preset.samplers;
    if (!preset.filters.empty()) root[preset.name]["filters"] = preset.filters;
  }
  return json_text(root);
}

std::string table_text(const ListedTable& table) {
  ordered_json list = ordered_json::array();
  for (const std::vector<std::string>& row : table.rows) {
    ordered_json entry;
    for (std::size_t c = 0; c < row.size(); ++c)
      entry[table.columns[c]] = row[c];
    list.push_back(std::move(entry));
  }
  return json_text(list);
}

std::string names_text(const ListedNames& names) {
  ordered_json root;
  for (const auto& [what, list] : names)
    root[what] = list;
  return json_text(root);
}

}  // namespace spool::tools
