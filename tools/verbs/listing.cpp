#include "tools/verbs/listing.h"

#include <algorithm>

#include "lib/exchange/foreign_formats.h"
#include "lib/experiment/result_table.h"
#include "lib/filters/filter_stage.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/sanitise.h"
#include "lib/synthetic/synthetic_scenes.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/view_files.h"

namespace spool::tools {
namespace {

ListedOption listed(const OptionDescription& option) {
  return {option.name, option.allowed, option.help, option.expert, false, {}};
}

std::vector<ListedOption> with_defaults(const std::vector<OptionDescription>& descriptions) {
  std::vector<ListedOption> options;
  for (const OptionDescription& option : descriptions) {
    options.push_back(listed(option));
    options.back().defaults = {{"default", option.value}};
  }
  return options;
}

// Options of a method with one default per preset.
template <class Function>
std::vector<ListedOption> options_of(const Method<Function>& entry) {
  std::vector<std::string> presets = entry.presets;
  if (presets.empty()) presets.emplace_back();
  std::vector<ListedOption> options;
  for (const OptionDescription& option : entry.describe(presets.front()))
    options.push_back(listed(option));
  for (const std::string& preset : presets) {
    const std::vector<OptionDescription> described = entry.describe(preset);
    for (std::size_t i = 0; i < described.size(); ++i)
      options[i].defaults.emplace_back(preset.empty() ? "default" : preset, described[i].value);
  }
  return options;
}

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
ListedMethods listed(const MethodList<Function>& entries) {
  ListedMethods list;
  for (const Method<Function>& entry : entries)
    list.push_back({entry.name, entry.summary, options_of(entry), entry.argument,
                    entry.source == Source::kDescriptions, needs_of(entry.needs), entry.footprints,
                    entry.presets, entry.readings});
  return list;
}

template <class Formats>
ListedMethods listed_formats(const Formats& formats) {
  ListedMethods list;
  for (const auto& format : formats)
    list.push_back({format.name, format.summary, with_defaults(format.describe())});
  return list;
}

template <class Methods>
void add_presets(std::vector<ListedPreset>& presets, const Methods& methods,
                 std::vector<std::string> ListedPreset::* kind) {
  for (const auto& entry : methods) {
    for (const std::string& preset : entry.presets) {
      auto found = std::ranges::find(presets, preset, &ListedPreset::name);
      if (found == presets.end()) found = presets.insert(presets.end(), {preset, {}, {}});
      ((*found).*kind).push_back(entry.name);
    }
  }
}

std::vector<std::string> named_in(const ListedTable& table) {
  const auto at = std::ranges::find(table.columns, "name") - table.columns.begin();
  std::vector<std::string> names;
  for (const auto& row : table.rows) {  // views of two methods may have one name
    const std::string& name = row[static_cast<std::size_t>(at)];
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

ListedMethods listed_samplers() {
  return listed(known_samplers());
}

std::vector<ListedOption> options_of_every_filter() {
  return with_defaults(stage_options());
}

std::vector<ListedOption> options_of_the_pool() {
  return with_defaults(describe_options(sanitise_option_table(), SanitiseRules{}));
}

std::vector<ListedOption> options_of_metrics() {
  return with_defaults(describe_options(metric_option_table(), MetricOptions{}));
}

ListedMethods listed_filters() {
  ListedMethods list = listed(known_filters());
  for (const OptionDescription& shared : stage_options()) {
    for (ListedMethod& filter : list) {
      for (ListedOption& option : filter.options)
        option.of_every =
            option.of_every || (option.name == shared.name && option.help == shared.help);
    }
  }
  return list;
}

ListedMethods listed_imports() {
  return listed_formats(exchange::import_formats());
}

ListedMethods listed_exports() {
  return listed_formats(exchange::export_formats());
}

std::vector<ListedPreset> listed_presets() {
  std::vector<ListedPreset> presets;
  add_presets(presets, samplers(), &ListedPreset::samplers);
  add_presets(presets, filters(), &ListedPreset::filters);
  return presets;
}

ListedTable listed_metrics() {
  ListedTable table{{"name", "better", "meaning"}, {}};
  for (const MetricDescription& metric : metrics())
    table.rows.push_back({metric.name, std::string(better_name(metric.better)), metric.meaning});
  return table;
}

ListedTable listed_columns() {
  ListedTable table{{"name", "meaning"}, {}};
  for (const ResultColumn& column : result_columns())
    table.rows.push_back({column.name, column.meaning});
  return table;
}

ListedTable listed_views() {
  ListedTable table{{"of", "name", "meaning"}, {}};
  const auto add = [&](const std::string& method, const std::vector<ViewDescription>& views) {
    for (const ViewDescription& view : views)
      table.rows.push_back({method, view.name, view.meaning});
  };
  add("every sampler", selection_views());
  for (const Sampler& entry : samplers())
    add("sampler " + entry.name, entry.views);
  add("every filter", image_views());
  for (const Filter& entry : filters())
    add("filter " + entry.name, entry.views);
  return table;
}

ListedTable listed_scenes() {
  ListedTable table{{"name", "summary"}, {}};
  for (const SyntheticEntry& scene : synthetic_scenes())
    table.rows.push_back({scene.name, scene.summary});
  return table;
}

ListedTable listed_scene_options() {
  ListedTable table{{"--set", "allowed", "default", "meaning"}, {}};
  for (const auto& option : describe_options(synthetic_option_table(), SyntheticOptions{}))
    table.rows.push_back({option.name, option.allowed, option.value, option.help});
  return table;
}

ListedNames listed_names() {
  return {{"samplers", names_of(listed_samplers())}, {"filters", names_of(listed_filters())},
          {"metrics", named_in(listed_metrics())},   {"scenes", named_in(listed_scenes())},
          {"views", named_in(listed_views())},       {"columns", named_in(listed_columns())},
          {"imports", names_of(listed_imports())},   {"exports", names_of(listed_exports())},
          {"pool", names_of(options_of_the_pool())}};
}

}  // namespace spool::tools
