#include "tools/verbs/list.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include <nlohmann/json.hpp>

#include "lib/exchange/foreign_formats.h"
#include "lib/experiment/result_table.h"
#include "lib/metrics/error_metrics.h"
#include "lib/synthetic/synthetic_scenes.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/view_files.h"
#include "tools/terminal/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

// Options of a method with one default per preset.
template <class Function>
ordered_json options_of(const Method<Function>& entry) {
  std::vector<std::string> presets = entry.presets;
  if (presets.empty()) presets.emplace_back();
  ordered_json options = ordered_json::array();
  for (const OptionDescription& option : entry.describe(presets.front())) {
    options.push_back({{"name", option.name},
                       {"allowed", option.allowed},
                       {"help", option.help},
                       {"expert", option.expert}});
  }
  for (const std::string& preset : presets) {
    const std::vector<OptionDescription> described = entry.describe(preset);
    for (std::size_t i = 0; i < described.size(); ++i) {
      options[i]["defaults"][preset.empty() ? "default" : preset] = described[i].value;
    }
  }
  return options;
}

// What a method needs, for people.
std::vector<std::string> needs_of(const Needs& needs) {
  std::vector<std::string> words;
  const auto use = [&](Use of, const std::string& what) {
    if (of != Use::kNone) words.push_back(what + (of == Use::kRequired ? "" : " if recorded"));
  };
  use(needs.features, "albedo, normal or depth");
  use(needs.film_positions, "film positions");
  if (needs.reference) words.emplace_back("the reference");
  if (needs.filter_in_loop) {
    words.push_back(needs.loop_filter.empty() ? "the filter beside it"
                                              : "in its loop: " + needs.loop_filter);
  }
  return words;
}

template <class Function>
ordered_json describe(const MethodList<Function>& entries) {
  ordered_json list = ordered_json::array();
  for (const Method<Function>& entry : entries) {
    list.push_back({{"name", entry.name},
                    {"summary", entry.summary},
                    {"argument", entry.argument},
                    {"by_description", entry.source == Source::kDescriptions},
                    {"needs", needs_of(entry.needs)},
                    {"footprints", entry.footprints},
                    {"presets", entry.presets},
                    {"options", options_of(entry)}});
  }
  return list;
}

void print_methods(const ordered_json& list, const std::string& part, bool all) {
  for (const auto& method : list) {
    const std::string argument = method.value("argument", "");
    const bool by_description = method.value("by_description", false);
    print(fmt::format(
        "{}{}{}: {}\n", method["name"].get<std::string>(), argument.empty() ? "" : ":" + argument,
        by_description ? kByDescriptionMark : "", method["summary"].get<std::string>()));
    if (by_description) print(fmt::format("  {}\n", kByDescription));
    if (const auto needs = method.value("needs", std::vector<std::string>()); !needs.empty()) {
      print(fmt::format("  needs {}\n", fmt::join(needs, ", ")));
    }
    if (method.value("footprints", false)) print("  says its weights: spool pixel --filter\n");
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> header = {"  --set " + part + ".", "allowed"};
    std::size_t left_out = 0;
    for (const auto& option : method["options"]) {
      if (!all && option["expert"].get<bool>()) {
        ++left_out;
        continue;
      }
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
    if (left_out > 0) print(fmt::format("  {} more with --all\n", left_out));
    print("\n");
  }
}

template <class Formats>
ordered_json describe_foreign(const Formats& formats) {
  ordered_json list = ordered_json::array();
  for (const auto& format : formats) {
    ordered_json options = ordered_json::array();
    for (const OptionDescription& option : format.describe()) {
      options.push_back({{"name", option.name},
                         {"allowed", option.allowed},
                         {"help", option.help},
                         {"defaults", {{"default", option.value}}}});
    }
    list.push_back({{"name", format.name}, {"summary", format.summary}, {"options", options}});
  }
  return list;
}

ordered_json describe_presets() {
  ordered_json presets = ordered_json::object();
  for (const Sampler& entry : samplers()) {
    for (const std::string& preset : entry.presets) {
      presets[preset]["samplers"].push_back(entry.name);
    }
  }
  for (const Filter& entry : filters()) {
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

const char* better_name(Better better) {
  return better == Better::kLower ? "lower" : (better == Better::kHigher ? "higher" : "near 1");
}

ordered_json describe_metrics() {
  ordered_json list = ordered_json::array();
  for (const MetricDescription& metric : metrics()) {
    list.push_back({{"name", metric.name},
                    {"better", better_name(metric.better)},
                    {"meaning", metric.meaning}});
  }
  return list;
}

ordered_json describe_columns() {
  ordered_json list = ordered_json::array();
  for (const ResultColumn& column : result_columns()) {
    list.push_back({{"name", column.name}, {"meaning", column.meaning}});
  }
  return list;
}

ordered_json describe_views() {
  ordered_json list = ordered_json::array();
  const auto add = [&](const std::string& method, const std::vector<ViewDescription>& views) {
    for (const ViewDescription& view : views)
      list.push_back({{"of", method}, {"name", view.name}, {"meaning", view.meaning}});
  };
  add("every sampler", selection_views());
  for (const Sampler& entry : samplers())
    add("sampler " + entry.name, entry.views);
  add("every filter", image_views());
  for (const Filter& entry : filters())
    add("filter " + entry.name, entry.views);
  return list;
}

ordered_json describe_scenes() {
  ordered_json list = ordered_json::array();
  for (const SyntheticEntry& scene : synthetic_scenes()) {
    list.push_back({{"name", scene.name}, {"summary", scene.summary}});
  }
  return list;
}

ordered_json describe_scene_options() {
  ordered_json list = ordered_json::array();
  for (const auto& option : describe_options(synthetic_option_table(), SyntheticOptions{})) {
    list.push_back({{"--set", option.name},
                    {"allowed", option.allowed},
                    {"default", option.value},
                    {"meaning", option.help}});
  }
  return list;
}

// Rows of equal keys as columns under their names.
void print_table(const ordered_json& list) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& entry : list) {
    std::vector<std::string> header;
    std::vector<std::string> row;
    for (const auto& [key, value] : entry.items()) {
      header.push_back(key);
      row.push_back(value.get<std::string>());
    }
    if (rows.empty()) rows.push_back(header);
    rows.push_back(row);
  }
  print(format_columns(rows, 100));
}

// {list: names of its entries}
ordered_json describe_all() {
  ordered_json overview;
  for (const auto& [what, list] : std::initializer_list<std::pair<const char*, ordered_json>>{
           {"samplers", describe(known_samplers())},
           {"filters", describe(known_filters())},
           {"metrics", describe_metrics()},
           {"scenes", describe_scenes()},
           {"views", describe_views()},
           {"columns", describe_columns()},
           {"imports", describe_foreign(exchange::import_formats())},
           {"exports", describe_foreign(exchange::export_formats())}}) {
    overview[what] = ordered_json::array();
    for (const ordered_json& entry : list)
      overview[what].push_back(entry["name"]);
  }
  return overview;
}

void print_overview(const ordered_json& overview) {
  constexpr std::size_t kNamed = 12;
  std::vector<std::vector<std::string>> rows = {{"spool list", "", "names"}};
  for (const auto& [what, names] : overview.items()) {
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i)
      text += (i > 0 ? ", " : "") + names[i].get<std::string>();
    if (names.size() > kNamed) text += ", ...";
    rows.push_back({what, std::to_string(names.size()), text});
  }
  print(format_columns(rows, rows.size()));
}

}  // namespace

Result<void> run_list(const ListOptions& options, const CommonOptions& common) {
  if (options.what.empty()) {
    const ordered_json overview = describe_all();
    common.json ? print(json_text(overview)) : print_overview(overview);
    return {};
  }
  if (options.what == "presets") {
    const ordered_json presets = describe_presets();
    common.json ? print(json_text(presets)) : print_presets(presets);
    return {};
  }
  if (options.what == "views") {
    const ordered_json list = describe_views();
    common.json ? print(json_text(list)) : print_table(list);
    return {};
  }
  if (options.what == "metrics" || options.what == "columns") {
    const ordered_json list = options.what == "metrics" ? describe_metrics() : describe_columns();
    common.json ? print(json_text(list)) : print_table(list);
    return {};
  }
  if (options.what == "imports" || options.what == "exports") {
    const bool in = options.what == "imports";
    const ordered_json list = in ? describe_foreign(exchange::import_formats())
                                 : describe_foreign(exchange::export_formats());
    common.json ? print(json_text(list)) : print_methods(list, in ? "import" : "export", true);
    return {};
  }
  if (options.what == "scenes") {
    if (common.json) {
      print(json_text(describe_scenes()));
      return {};
    }
    print_table(describe_scenes());
    print("\n");
    print_table(describe_scene_options());
    return {};
  }
  const bool filters = options.what == "filters";
  const ordered_json list = filters ? describe(known_filters()) : describe(known_samplers());
  common.json ? print(json_text(list))
              : print_methods(list, filters ? "filter" : "sampler", options.all);
  return {};
}

}  // namespace spool::tools
