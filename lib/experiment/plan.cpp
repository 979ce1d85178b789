#include "lib/experiment/plan.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <toml++/toml.h>

#include "lib/experiment/toml_nesting.h"

namespace spool {
namespace {

template <class Entry, class Function>
struct MethodKind {
  std::string list_key;   // "samplers"
  std::string table_key;  // "sampler"
  const std::vector<Entry>& entries;
  const std::function<Result<Function>(const MethodChoice&)>& make;  // of names with a colon
};
using SamplerKind = MethodKind<SamplerEntry, SamplerFunction>;
using FilterKind = MethodKind<ReconstructorEntry, ReconstructorFunction>;

class PlanReader {
 public:
  PlanReader(const toml::table& root, std::string name, std::filesystem::path folder)
      : root_(root), name_(std::move(name)), folder_(std::move(folder)) {}

  Result<Plan> read(const PlanVocabulary& vocabulary) {
    Plan plan;
    SPOOL_TRY(check_keys());
    SPOOL_TRY(read_value("title", plan.title,
                         [](const std::string& text) -> Result<std::string> { return text; }));
    SPOOL_TRY(read_recordings(plan));
    SPOOL_TRY(read_budgets(plan));
    SPOOL_TRY(read_experiment(plan));
    SPOOL_TRY(read_options("pool", sanitise_option_table(), plan.rules));
    SPOOL_TRY(read_options("metrics", metric_option_table(), plan.experiment.metrics));
    SPOOL_ASSIGN(plan.samplers, read_methods(SamplerKind{"samplers", "sampler", vocabulary.samplers,
                                                         vocabulary.make_sampler}));
    SPOOL_ASSIGN(plan.filters, read_methods(FilterKind{"filters", "filter", vocabulary.filters,
                                                       vocabulary.make_filter}));
    SPOOL_TRY(read_masks(plan));
    SPOOL_TRY(check_recording_names(plan));
    return plan;
  }

 private:
  template <class... Args>
  tl::unexpected<Error> refuse(const toml::node& where, fmt::format_string<Args...> format,
                               Args&&... args) const {
    return fail(ErrorCode::kUsage, "{}:{}: {}", name_, where.source().begin.line,
                fmt::format(format, std::forward<Args>(args)...));
  }

  static std::string hint(std::string_view word, const std::vector<std::string>& known) {
    const std::string near = nearest_name(word, known);
    return near.empty() ? std::string() : fmt::format(", did you mean '{}'?", near);
  }

  Result<void> check_keys() const {
    const std::vector<std::string> known = {"title",      "recordings",    "spp",
                                            "replicates", "seed",          "order",
                                            "reference",  "holdout",       "pieces_per_side",
                                            "samplers",   "filters",       "sampler",
                                            "filter",     "pool",          "metrics",
                                            "threads",    "repeats",       "pictures",
                                            "mask",       "decision_split"};
    for (const auto& [key, node] : root_) {
      bool found = false;
      for (const std::string& k : known)
        found = found || k == key.str();
      if (!found) return refuse(node, "unknown key '{}'{}", key.str(), hint(key.str(), known));
    }
    return {};
  }

  // The values of a key that holds one value or a list.
  static std::vector<const toml::node*> values_of(const toml::node& node) {
    std::vector<const toml::node*> values;
    if (const toml::array* list = node.as_array()) {
      for (const toml::node& value : *list)
        values.push_back(&value);
    } else {
      values.push_back(&node);
    }
    return values;
  }

  Result<std::string> text_of(const toml::node& node) const {
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto whole = node.value_exact<std::int64_t>()) return std::to_string(*whole);
    if (const auto number = node.value_exact<double>()) return format_number(*number);
    if (const auto flag = node.value_exact<bool>()) return std::string(*flag ? "on" : "off");
    return refuse(node, "a number, a text or true/false is wanted here");
  }

  template <class Value, class Parse>
  Result<void> read_value(const char* key, Value& value, Parse&& parse) const {
    const toml::node* node = root_.get(key);
    if (!node) return {};
    SPOOL_ASSIGN(const std::string text, text_of(*node));
    auto parsed = parse(text);
    if (!parsed) return refuse(*node, "{}", parsed.error().message);
    value = *parsed;
    return {};
  }

  Result<void> read_recordings(Plan& plan) const {
    const toml::node* node = root_.get("recordings");
    if (!node || values_of(*node).empty()) {
      return fail(ErrorCode::kUsage, "{}: no recordings: write recordings = [\"FILE.spool\"]",
                  name_);
    }
    for (const toml::node* value : values_of(*node)) {
      SPOOL_ASSIGN(const std::string text, text_of(*value));
      plan.recordings.push_back((folder_ / text).lexically_normal().string());
    }
    return {};
  }

  Result<void> read_budgets(Plan& plan) const {
    const toml::node* node = root_.get("spp");
    if (!node || values_of(*node).empty()) {
      return fail(ErrorCode::kUsage, "{}: no budgets: write spp = [4, 8, 16]", name_);
    }
    for (const toml::node* value : values_of(*node)) {
      SPOOL_ASSIGN(const std::string text, text_of(*value));
      const auto budget = parse_number("spp", text, 1e-3, 65536.0);
      if (!budget) return refuse(*value, "{}", budget.error().message);
      if (std::ranges::find(plan.spp, *budget) != plan.spp.end()) {
        return refuse(*value, "spp {} is there twice", *budget);
      }
      plan.spp.push_back(*budget);
    }
    return {};
  }

  Result<void> read_experiment(Plan& plan) const {
    constexpr int kMost = std::numeric_limits<int>::max();
    const auto integer = [](const char* key, int lowest, int highest) {
      return [=](const std::string& text) { return parse_integer(key, text, lowest, highest); };
    };
    SPOOL_TRY(read_value("replicates", plan.replicates, integer("replicates", 1, 10000)));
    SPOOL_TRY(read_value("seed", plan.experiment.seed, integer("seed", 0, kMost)));
    SPOOL_TRY(read_value("holdout", plan.experiment.holdout, integer("holdout", 0, 65536)));
    SPOOL_TRY(read_value("pieces_per_side", plan.experiment.pieces_per_side,
                         integer("pieces_per_side", 1, 2)));
    SPOOL_TRY(read_value("repeats", plan.experiment.repeats, integer("repeats", 1, 1000)));
    SPOOL_TRY(read_threads(plan));
    SPOOL_TRY(read_value("pictures", plan.pictures, [](const std::string& text) -> Result<bool> {
      if (text == "on" || text == "off") return text == "on";
      return fail(ErrorCode::kUsage, "pictures is true or false, not '{}'", text);
    }));
    SPOOL_TRY(read_value("decision_split", plan.experiment.decision_split,
                         [](const std::string& text) -> Result<bool> {
                           if (text == "on" || text == "off") return text == "on";
                           return fail(ErrorCode::kUsage,
                                       "decision_split is true or false, not '{}'", text);
                         }));
    SPOOL_TRY(read_value("reference", plan.experiment.reference, parse_reference_kind));
    return read_value(
        "order", plan.experiment.order, [](const std::string& text) -> Result<PoolOrder> {
          if (text == "shuffled") return PoolOrder::kShuffled;
          if (text == "recorded") return PoolOrder::kRecorded;
          return fail(ErrorCode::kUsage, "order is shuffled or recorded, not '{}'", text);
        });
  }

  Result<void> read_threads(Plan& plan) const {
    const toml::node* node = root_.get("threads");
    if (!node) return {};
    plan.threads.clear();
    for (const toml::node* value : values_of(*node)) {
      SPOOL_ASSIGN(const std::string text, text_of(*value));
      const auto threads = parse_integer("threads", text, 0, 1024);
      if (!threads) return refuse(*value, "{}", threads.error().message);
      if (std::ranges::find(plan.threads, *threads) != plan.threads.end()) {
        return refuse(*value, "threads {} is there twice", *threads);
      }
      plan.threads.push_back(*threads);
    }
    if (plan.threads.empty()) return refuse(*node, "'threads' has no value to sweep over");
    return {};
  }

  Result<void> read_masks(Plan& plan) const {
    const toml::node* tables = root_.get("mask");
    if (!tables) return {};
    const std::vector<std::string> known = {"name", "file", "recording"};
    for (const toml::node* node : values_of(*tables)) {
      const toml::table* table = node->as_table();
      if (!table) return refuse(*node, "write [[mask]] and below it name = ... and file = ...");
      EnergyMask mask;
      for (const auto& [key, value] : *table) {
        SPOOL_ASSIGN(const std::string text, text_of(value));
        if (key.str() == "name") {
          mask.name = text;
        } else if (key.str() == "file") {
          mask.path = (folder_ / text).lexically_normal().string();
        } else if (key.str() == "recording") {
          mask.recording = std::filesystem::path(text).filename().string();
        } else {
          return refuse(value, "unknown key '{}' of a mask{}", key.str(), hint(key.str(), known));
        }
      }
      if (mask.name.find_first_of(" =") != std::string::npos || mask.name.empty() ||
          mask.path.empty()) {
        return refuse(*table, "a mask wants a name without spaces and a file");
      }
      plan.experiment.masks.push_back(std::move(mask));
    }
    return {};
  }

  template <class Options>
  Result<void> read_options(const char* key, const OptionTable<Options>& table,
                            Options& options) const {
    const toml::node* node = root_.get(key);
    if (!node) return {};
    const toml::table* values = node->as_table();
    if (!values) return refuse(*node, "[{}] is a table of options", key);
    for (const auto& [name, value] : *values) {
      SPOOL_ASSIGN(const std::string text, text_of(value));
      const auto set = set_option(table, options, name.str(), text);
      if (!set) return refuse(value, "{}", set.error().message);
    }
    return {};
  }

  template <class Kind>
  Result<std::vector<MethodChoice>> read_methods(const Kind& kind) const {
    std::vector<MethodChoice> choices;
    if (const toml::node* list = root_.get(kind.list_key)) {
      for (const toml::node* value : values_of(*list)) {
        SPOOL_ASSIGN(const std::string name, text_of(*value));
        SPOOL_TRY(add_checked(kind, {name, "", {}}, *value, choices));
      }
    }
    if (const toml::node* tables = root_.get(kind.table_key)) {
      for (const toml::node* node : values_of(*tables)) {
        const toml::table* table = node->as_table();
        if (!table) return refuse(*node, "write [[{}]] and below it name = ...", kind.table_key);
        SPOOL_TRY(add_swept(kind, *table, choices));
      }
    }
    if (choices.empty()) {
      return fail(ErrorCode::kUsage, "{}: no {}: write {} = [\"NAME\"] or [[{}]]", name_,
                  kind.list_key, kind.list_key, kind.table_key);
    }
    return choices;
  }

  // Every combination of the values of a table's keys, the last key (by alphabet) fastest.
  template <class Kind>
  Result<void> add_swept(const Kind& kind, const toml::table& table,
                         std::vector<MethodChoice>& choices) const {
    const toml::node* name = table.get("name");
    if (!name) return refuse(table, "this {} has no name", kind.table_key);
    std::vector<MethodChoice> combinations(1);
    SPOOL_ASSIGN(combinations[0].name, text_of(*name));
    for (const auto& [key, node] : table) {
      if (key.str() == "name") continue;
      std::vector<MethodChoice> grown;
      for (const MethodChoice& choice : combinations) {
        for (const toml::node* value : values_of(node)) {
          SPOOL_ASSIGN(const std::string text, text_of(*value));
          grown.push_back(choice);
          if (key.str() == "preset") {
            grown.back().preset = text;
          } else {
            grown.back().set.emplace_back(key.str(), text);
          }
        }
      }
      if (grown.empty()) return refuse(node, "'{}' has no value to sweep over", key.str());
      combinations = std::move(grown);
    }
    for (MethodChoice& choice : combinations)
      SPOOL_TRY(add_checked(kind, std::move(choice), table, choices));
    return {};
  }

  template <class Kind>
  Result<void> add_checked(const Kind& kind, MethodChoice choice, const toml::node& where,
                           std::vector<MethodChoice>& choices) const {
    std::vector<std::string> names;
    for (const auto& entry : kind.entries)
      names.push_back(entry.name);
    const auto named = std::ranges::find(names, choice.name);
    const bool described = choice.name.find(':') != std::string::npos && kind.make;
    if (named == names.end() && !described) {
      return refuse(where, "unknown {} '{}'{}", kind.table_key, choice.name,
                    hint(choice.name, names));
    }
    const auto made = named == names.end()
                          ? kind.make(choice)
                          : kind.entries[static_cast<std::size_t>(named - names.begin())].make(
                                choice.preset, choice.set);
    if (!made) return refuse(where, "{} {}: {}", kind.table_key, choice.name, made.error().message);
    if (std::ranges::find(choices, choice) != choices.end()) {
      return refuse(where, "{} {} is there twice", kind.table_key, choice.label());
    }
    choices.push_back(std::move(choice));
    return {};
  }

  const toml::table& root_;
  std::string name_;
  std::filesystem::path folder_;
};

}  // namespace

Result<Plan> parse_plan(std::string_view text, const std::string& name,
                        const std::filesystem::path& folder, const PlanVocabulary& vocabulary) {
  if (text.size() > kMaxTomlBytes) {
    return fail(ErrorCode::kUsage, "{}: {} bytes are more than the {} of a plan: split it", name,
                text.size(), kMaxTomlBytes);
  }
  if (const std::size_t line = line_nested_too_deeply(text); line != 0) {
    return fail(ErrorCode::kUsage, "{}:{}: keys or brackets nest deeper than {}: correct the TOML",
                name, line, kMaxTomlDepth);
  }
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::kUsage, "{}:{}: {}: correct the TOML", name, error.source().begin.line,
                error.description());
  }
  return PlanReader(root, name, folder).read(vocabulary);
}

Result<Plan> read_plan(const std::filesystem::path& path, const PlanVocabulary& vocabulary) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (!file) return fail(ErrorCode::kIo, "{}: cannot be read", path.string());
  return parse_plan(text, path.string(), path.parent_path(), vocabulary);
}

}  // namespace spool
