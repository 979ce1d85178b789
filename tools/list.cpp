#include "tools/list.h"

#include <nlohmann/json.hpp>

#include "lib/reconstruction/reconstructor.h"
#include "lib/sampling/sampler.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr const char* kByDescription =
    "re-implemented from published descriptions, not from the primary text";

// Options of a method with one default per preset.
template <class Entry>
ordered_json options_of(const Entry& entry) {
  std::vector<std::string> presets = entry.presets;
  if (presets.empty()) presets.emplace_back();
  ordered_json options = ordered_json::array();
  for (const OptionDescription& option : entry.describe(presets.front())) {
    options.push_back({{"name", option.name}, {"allowed", option.allowed}, {"help", option.help}});
  }
  for (const std::string& preset : presets) {
    const std::vector<OptionDescription> described = entry.describe(preset);
    for (std::size_t i = 0; i < described.size(); ++i) {
      options[i]["defaults"][preset.empty() ? "default" : preset] = described[i].value;
    }
  }
  return options;
}

template <class Entry>
ordered_json describe(const std::vector<Entry>& entries) {
  ordered_json list = ordered_json::array();
  for (const Entry& entry : entries) {
    list.push_back({{"name", entry.name},
                    {"summary", entry.summary},
                    {"by_description", entry.by_description},
                    {"presets", entry.presets},
                    {"options", options_of(entry)}});
  }
  return list;
}

void print_methods(const ordered_json& list, const std::string& part) {
  for (const auto& method : list) {
    print(fmt::format("{}: {}\n", method["name"].get<std::string>(),
                      method["summary"].get<std::string>()));
    if (method["by_description"].get<bool>()) print(fmt::format("  ({})\n", kByDescription));
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> header = {"  --set " + part + ".", "allowed"};
    for (const auto& option : method["options"]) {
      std::vector<std::string> row = {"  " + option["name"].get<std::string>(),
                                      option["allowed"].get<std::string>()};
      for (const auto& [preset, value] : option["defaults"].items()) {
        if (rows.empty()) header.push_back(preset);
        row.push_back(value.get<std::string>());
      }
      row.push_back(option["help"].get<std::string>());
      if (rows.empty()) {
        header.emplace_back("meaning");
        rows.push_back(header);
      }
      rows.push_back(row);
    }
    if (!rows.empty()) print(format_columns(rows, 100));
    print("\n");
  }
}

ordered_json describe_presets() {
  ordered_json presets = ordered_json::object();
  for (const SamplerEntry& entry : samplers()) {
    for (const std::string& preset : entry.presets) {
      presets[preset]["samplers"].push_back(entry.name);
    }
  }
  for (const ReconstructorEntry& entry : reconstructors()) {
    for (const std::string& preset : entry.presets) {
      presets[preset]["filters"].push_back(entry.name);
    }
  }
  return presets;
}

void print_presets(const ordered_json& presets) {
  for (const auto& [preset, methods] : presets.items()) {
    print(preset + "\n");
    for (const auto& [kind, names] : methods.items()) {
      std::string line;
      for (const auto& name : names)
        line += (line.empty() ? "" : ", ") + name.get<std::string>();
      print(fmt::format("  {}: {}\n", kind, line));
    }
  }
}

}  // namespace

Result<void> run_list(const ListOptions& options, const CommonOptions& common) {
  if (options.what == "presets") {
    const ordered_json presets = describe_presets();
    common.json ? print(presets.dump(2) + "\n") : print_presets(presets);
    return {};
  }
  const bool filters = options.what == "filters";
  const ordered_json list = filters ? describe(reconstructors()) : describe(samplers());
  common.json ? print(list.dump(2) + "\n") : print_methods(list, filters ? "filter" : "sampler");
  return {};
}

}  // namespace spool::tools
