#include "lib/experiment/plan_text.h"

#include <filesystem>
#include <sstream>

#include <toml++/toml.h>

#include "lib/core/visible_text.h"

namespace spool {
namespace {

template <class Options>
toml::table options_table(const OptionTable<Options>& known, const Options& options) {
  toml::table table;
  for (const auto& [name, value] : option_values(known, options))
    table.insert(name, value);
  return table;
}

toml::table metrics_table(const MetricOptions& options) {
  toml::table table = options_table(metric_option_table(), options);
  toml::array only;
  for (std::size_t m = 0; m < options.wanted.size(); ++m)
    if (options.wanted[m]) only.push_back(metrics()[m].name);
  if (!only.empty()) table.insert("only", only);
  return table;
}

// What TOML cannot hold or parse_plan() would read otherwise, with percent signs.
std::string text_of_file(const std::string& name) {
  if (is_utf8(name) && !name.starts_with("file:")) return name;
  std::string text = "file:";
  for (const char c : name) {
    const bool plain = c > 0x20 && c < 0x7F && c != '%';
    text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

toml::array method_tables(const std::vector<MethodChoice>& methods) {
  toml::array tables;
  for (const MethodChoice& method : methods) {
    toml::table table{{"name", method.name}};
    if (!method.own_label.empty()) table.insert("label", method.own_label);
    if (!method.preset.empty()) table.insert("preset", text_of_file(method.preset));
    for (const auto& [name, value] : method.set)
      table.insert_or_assign(name, value);
    tables.push_back(table);
  }
  return tables;
}

std::string absolute_path(const std::string& path) {
  return text_of_file(std::filesystem::absolute(path).lexically_normal().string());
}

toml::array dump_tables(const Plan& plan) {
  toml::array tables;
  for (std::size_t i = 0; i < plan.recordings.size(); ++i) {
    toml::table table{{"file", absolute_path(plan.recordings[i])}};
    if (!plan.group_of(i).empty()) table.insert("group", plan.group_of(i));
    tables.push_back(table);
  }
  return tables;
}

template <class Value>
toml::array list_of(const std::vector<Value>& values) {
  toml::array list;
  for (const Value& value : values)
    list.push_back(value);
  return list;
}

toml::array claim_tables(const std::vector<Claim>& claims) {
  toml::array tables;
  for (const Claim& claim : claims) {
    toml::table table{{"text", claim.text},   {"better", claim.better},
                      {"than", claim.than},   {"metric", claim.metric},
                      {"below", claim.below}, {"samples", claim.fresh ? "fresh" : "own"}};
    if (!claim.spp.empty()) table.insert("spp", list_of(claim.spp));
    if (claim.threads > 0) table.insert("threads", claim.threads);
    if (claim.than_threads > 0) table.insert("than_threads", claim.than_threads);
    if (!claim.source.empty()) table.insert("source", claim.source);
    tables.push_back(table);
  }
  return tables;
}

}  // namespace

std::string plan_text(const Plan& plan) {
  const ExperimentOptions& e = plan.experiment;
  toml::table root{{"title", plan.title},
                   {"spp", list_of(plan.spp)},
                   {"replicates", plan.replicates},
                   {"threads", list_of(plan.threads)},
                   {"repeats", e.repeats},
                   {"pictures", plan.pictures},
                   {"seed", static_cast<std::int64_t>(e.seed)},
                   {"order", std::string(order_name(e.order))},
                   {"pieces_per_side", e.pieces_per_side},
                   {"decision_split", e.decision_split},
                   {"fresh", e.fresh},
                   {"halves", e.halves > 0 || plan.replicates == 1},
                   {"sampler", method_tables(plan.samplers)},
                   {"filter", method_tables(plan.filters)},
                   {"pool", options_table(sanitise_option_table(), plan.rules)},
                   {"metrics", metrics_table(e.metrics)}};
  if (plan.groups.empty()) {
    std::vector<std::string> recordings;
    for (const std::string& recording : plan.recordings)
      recordings.push_back(absolute_path(recording));
    root.insert("recordings", list_of(recordings));
  } else {
    root.insert("dump", dump_tables(plan));
  }
  if (plan.energy_band) {
    root.insert("energy_band", toml::array{plan.energy_band->first, plan.energy_band->second});
  }
  toml::array masks;
  for (const EnergyMask& mask : e.masks) {
    toml::table table{{"name", mask.name}, {"file", absolute_path(mask.path)}};
    if (!mask.recording.empty()) table.insert("recording", text_of_file(mask.recording));
    masks.push_back(table);
  }
  if (!masks.empty()) root.insert("mask", masks);
  if (!plan.baseline.empty()) root.insert("baseline", plan.baseline);
  if (!plan.claims.empty()) root.insert("claim", claim_tables(plan.claims));
  if (e.reference) root.insert("reference", std::string(reference_name(*e.reference)));
  if (e.holdout) root.insert("holdout", *e.holdout);
  std::ostringstream text;
  text << root << "\n";
  return text.str();
}

}  // namespace spool
