#include "tools/json/list_json.h"

#include <nlohmann/json.hpp>

#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

ordered_json option_json(const ListedOption& option) {
  return {{"name", option.name}, {"allowed", option.allowed}, {"help", option.help}};
}

void add_defaults(ordered_json& entry, const ListedOption& option) {
  for (const auto& [preset, value] : option.defaults)
    entry["defaults"][preset] = value;
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
    ordered_json options = ordered_json::array();
    for (const ListedOption& option : method.options) {
      options.push_back(option_json(option));
      options.back()["expert"] = option.expert;
      add_defaults(options.back(), option);
    }
    list.push_back({{"name", method.name},
                    {"summary", method.summary},
                    {"argument", method.argument},
                    {"by_description", method.by_description},
                    {"needs", method.needs},
                    {"footprints", method.footprints},
                    {"presets", method.presets},
                    {"readings", readings_json(method.readings)},
                    {"options", options}});
  }
  return json_text(list);
}

std::string formats_text(const ListedMethods& formats) {
  ordered_json list = ordered_json::array();
  for (const ListedMethod& format : formats) {
    ordered_json options = ordered_json::array();
    for (const ListedOption& option : format.options) {
      options.push_back(option_json(option));
      add_defaults(options.back(), option);
    }
    list.push_back({{"name", format.name}, {"summary", format.summary}, {"options", options}});
  }
  return json_text(list);
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
