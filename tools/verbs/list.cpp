#include "tools/verbs/list.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "lib/core/error.h"
#include "lib/core/nearest_name.h"
#include "tools/json/list_json.h"
#include "tools/methods/external_methods.h"
#include "tools/verbs/listing.h"

namespace spool::tools {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// The options that are shown, one default a preset; empty without any.
Rows option_rows(const std::vector<ListedOption>& options, const std::string& part, bool all) {
  Rows rows;
  for (const ListedOption& option : options) {
    if (option.of_every || (!all && option.expert)) continue;
    if (rows.empty()) {
      rows.push_back({"  --set " + part + ".", "allowed"});
      for (const auto& [preset, value] : option.defaults)
        rows.front().push_back(preset);
      rows.front().emplace_back("meaning");
    }
    rows.push_back({"  " + option.name, option.allowed});
    for (const auto& [preset, value] : option.defaults)
      rows.back().push_back(value);
    rows.back().push_back(option.help);
  }
  return rows;
}

// What may stand behind a preset.
Rows reading_rows(const ListedMethod& method) {
  Rows rows;
  if (method.readings.empty()) return rows;
  rows.push_back({"  " + method.name + ":PRESET+", "of", "meaning"});
  for (const Reading& reading : method.readings)
    rows.push_back({"  " + reading.name, reading.of, reading.summary});
  return rows;
}

void print_wrapped(const std::string& line) {
  print(wrapped(line, line_width(), 2) + "\n");
}

void print_methods(const ListedMethods& list, const std::string& part, bool all) {
  for (const ListedMethod& method : list) {
    print_wrapped(fmt::format("{}{}{}: {}", method.name,
                              method.argument.empty() ? "" : ":" + method.argument,
                              method.by_description ? kByDescriptionMark : "", method.summary));
    if (method.by_description) print_wrapped(fmt::format("  {}", kByDescription));
    if (!method.needs.empty())
      print_wrapped(fmt::format("  needs {}", fmt::join(method.needs, ", ")));
    if (method.footprints) print("  returns its weights: spool pixel --filter\n");
    const Rows rows = option_rows(method.options, part, all);
    if (!rows.empty()) print(format_entries(rows));
    const auto left_out = std::ranges::count_if(
        method.options, [&](const ListedOption& o) { return !all && o.expert && !o.of_every; });
    if (left_out > 0) print(fmt::format("  {} more with --all\n", left_out));
    if (const Rows readings = reading_rows(method); !readings.empty())
      print(format_entries(readings));
    print("\n");
  }
}

// Options that no method has.
void print_options(const std::vector<ListedOption>& options, const std::string& part) {
  print(format_entries(option_rows(options, part, true)));
}

void print_for_every_filter() {
  print("every filter\n");
  print_options(options_of_every_filter(), "filter");
  print("\n");
}

void print_presets(const std::vector<ListedPreset>& presets) {
  for (const ListedPreset& preset : presets) {
    print(preset.name + "\n");
    const auto line = [](const char* kind, const std::vector<std::string>& names) {
      if (!names.empty()) print_wrapped(fmt::format("  {}: {}", kind, fmt::join(names, ", ")));
    };
    line("samplers", preset.samplers);
    line("filters", preset.filters);
  }
}

void print_table(const ListedTable& table) {
  Rows rows = table.rows;
  rows.insert(rows.begin(), table.columns);
  print(format_entries(rows));
}

void print_names(const ListedNames& overview) {
  constexpr std::size_t kNamed = 12;
  Rows rows = {{"spool list", "", "names"}};
  for (const auto& [what, names] : overview) {
    const std::size_t named = std::min(names.size(), kNamed);
    rows.push_back({what, std::to_string(names.size()),
                    fmt::format("{}{}", fmt::join(names.begin(), names.begin() + named, ", "),
                                names.size() > kNamed ? ", ..." : "")});
  }
  print(format_columns(rows, rows.size()));
}

// The methods of one name, with all their options.
Result<void> list_one(const ListOptions& options, const CommonOptions& common) {
  const auto others = [&](const ListedMethod& method) { return method.name != options.what; };
  ListedMethods samplers = listed_samplers(), filters = listed_filters();
  std::vector<std::string> known = lists();
  for (const ListedMethods* list : {&samplers, &filters}) {
    for (const ListedMethod& method : *list)
      known.push_back(method.name);
  }
  std::erase_if(samplers, others);
  std::erase_if(filters, others);
  if (samplers.empty() && filters.empty())
    return fail(ErrorCode::kUsage, "{}: see spool list",
                unknown_name("method or list", options.what, known));
  if (common.json) {
    ListedMethods both = std::move(samplers);
    std::ranges::move(filters, std::back_inserter(both));
    print(methods_text(both));
    return {};
  }
  print_methods(samplers, "sampler", true);
  print_methods(filters, "filter", true);
  if (!filters.empty()) print_for_every_filter();
  return {};
}

}  // namespace

std::vector<std::string> lists() {
  return {"samplers", "filters", "presets", "views",   "metrics",
          "columns",  "scenes",  "imports", "exports", "pool"};
}

Result<void> run_list(const ListOptions& options, const CommonOptions& common) {
  const std::string& what = options.what;
  const auto table = [&](const ListedTable& listed) {
    common.json ? print(table_text(listed)) : print_table(listed);
  };
  const auto methods = [&](const ListedMethods& listed, const char* part) {
    common.json ? print(methods_text(listed)) : print_methods(listed, part, options.all);
  };
  const auto formats = [&](const ListedMethods& listed, const char* part) {
    common.json ? print(formats_text(listed)) : print_methods(listed, part, true);
  };
  if (what.empty()) {
    const ListedNames names = listed_names();
    common.json ? print(names_text(names)) : print_names(names);
  } else if (what == "presets") {
    const std::vector<ListedPreset> presets = listed_presets();
    common.json ? print(presets_text(presets)) : print_presets(presets);
  } else if (what == "scenes") {
    table(listed_scenes());
    if (common.json) return {};
    print("\n");
    print_table(listed_scene_options());
  } else if (what == "views") {
    table(listed_views());
  } else if (what == "metrics") {
    table(listed_metrics());
    if (common.json) return {};
    print("\n");
    print_options(options_of_metrics(), "metrics");
  } else if (what == "pool") {
    const std::vector<ListedOption> rules = options_of_the_pool();
    common.json ? print(options_text(rules)) : print_options(rules, "pool");
  } else if (what == "columns") {
    table(listed_columns());
  } else if (what == "imports") {
    formats(listed_imports(), "import");
  } else if (what == "exports") {
    formats(listed_exports(), "export");
  } else if (what == "filters") {
    if (!common.json) print_for_every_filter();
    methods(listed_filters(), "filter");
  } else if (what == "samplers") {
    methods(listed_samplers(), "sampler");
  } else {
    return list_one(options, common);
  }
  return {};
}

}  // namespace spool::tools
