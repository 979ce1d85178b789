#include "lib/experiment/plan_methods.h"

#include <algorithm>

namespace spool {
namespace {

// "{a=1,b=2}": what of a choice is its own in a sweep; nothing outside of one.
std::string swept_values(const MethodChoice& choice, const std::vector<std::string>& swept) {
  std::string text;
  for (const std::string& key : swept) {
    const auto set =
        std::ranges::find(choice.set, key, [](const auto& option) { return option.first; });
    text += (text.empty() ? "" : ",") + key + "=" +
            (key == "preset" || set == choice.set.end() ? choice.preset : set->second);
  }
  return text.empty() ? text : "{" + text + "}";
}

// The methods of one kind of a plan, read from its text: samplers, or filters.
template <class Function>
class MethodReader {
 public:
  MethodReader(const TomlReader& toml, const MethodList<Function>& known, bool has_results)
      : toml_(toml), known_(known), has_results_(has_results) {}

  // Methods by name under the kind's plural ("samplers"), in full in tables under the kind itself.
  Result<std::vector<MethodChoice>> read(const toml::table& root) const {
    std::vector<MethodChoice> choices;
    if (const toml::node* list = root.get(known_.kind + "s")) {
      for (const toml::node* value : values_of(*list)) {
        SPOOL_ASSIGN(const std::string text, toml_.text_of(*value));
        SPOOL_ASSIGN(MethodChoice choice, toml_.at(*value, choose_method(known_, text)));
        SPOOL_TRY(add_checked(std::move(choice), *value, choices));
      }
    }
    if (const toml::node* tables = root.get(known_.kind)) {
      for (const toml::node* node : values_of(*tables)) {
        const toml::table* table = node->as_table();
        if (!table) return toml_.refuse(*node, "write [[{}]] and below it name = ...", known_.kind);
        SPOOL_TRY(add_swept(*table, choices));
      }
    }
    if (choices.empty()) {
      return fail(ErrorCode::kUsage, "{}: no {}s: write {}s = [\"NAME\"] or [[{}]]", toml_.name(),
                  known_.kind, known_.kind, known_.kind);
    }
    label_commands(known_, choices);
    return choices;
  }

 private:
  // Every combination of the values of a table's keys, the last key (by alphabet) fastest.
  Result<void> add_swept(const toml::table& table, std::vector<MethodChoice>& choices) const {
    const toml::node* name = table.get("name");
    if (!name) return toml_.refuse(table, "this {} has no name", known_.kind);
    SPOOL_ASSIGN(const std::string text, toml_.text_of(*name));
    SPOOL_ASSIGN(MethodChoice named, toml_.at(table, choose_method(known_, text)));
    if (const toml::node* label = table.get("label")) {
      SPOOL_ASSIGN(named.own_label, toml_.text_of(*label));
      if (named.own_label.empty()) return toml_.refuse(*label, "a label is empty: leave it out");
    }
    std::vector<MethodChoice> combinations = {std::move(named)};
    std::vector<std::string> swept;
    for (const auto& [key, node] : table) {
      if (key.str() == "name" || key.str() == "label") continue;
      if (values_of(node).size() > 1) swept.emplace_back(key.str());
      std::vector<MethodChoice> grown;
      for (const MethodChoice& choice : combinations) {
        for (const toml::node* value : values_of(node)) {
          SPOOL_ASSIGN(const std::string chosen, toml_.text_of(*value));
          grown.push_back(choice);
          if (key.str() == "preset") {
            grown.back().preset = file_of_text(chosen);  // of some methods the name of a file
          } else {
            grown.back().set.emplace_back(key.str(), chosen);
          }
          if (grown.size() > kMostValues) {
            return toml_.refuse(node, "more than {} combinations of values: sweep over fewer",
                                kMostValues);
          }
        }
      }
      if (grown.empty()) return toml_.refuse(node, "'{}' has no value to sweep over", key.str());
      combinations = std::move(grown);
    }
    for (MethodChoice& choice : combinations) {
      if (!choice.own_label.empty()) choice.own_label += swept_values(choice, swept);
      SPOOL_TRY(add_checked(std::move(choice), table, choices));
    }
    return {};
  }

  Result<void> checked(const MethodChoice& choice) const {
    const auto made = has_results_ ? describe_method(known_, choice) : make_method(known_, choice);
    return made.map([](const auto&) {});
  }

  // The key of a table whose value alone gives the error that the choice gives; else `where`.
  const toml::node& place_of(const Error& error, const MethodChoice& choice,
                             const toml::node& where) const {
    for (const auto& option : choice.set) {
      const toml::node* key = where.as_table() ? where.as_table()->get(option.first) : nullptr;
      MethodChoice alone = choice;
      alone.set = {option};
      const Result<void> found = checked(alone);
      if (key && !found && found.error().message == error.message) return *key;
    }
    return where;
  }

  Result<void> add_checked(MethodChoice choice, const toml::node& where,
                           std::vector<MethodChoice>& choices) const {
    const Result<void> ready = checked(choice);
    if (!ready) return toml_.at(place_of(ready.error(), choice, where), ready);
    SPOOL_TRY(toml_.at(where, check_own_label(known_, choice)));
    choices.push_back(std::move(choice));
    return toml_.at(where, check_distinct(known_.kind, choices));
  }

  const TomlReader& toml_;
  const MethodList<Function>& known_;
  bool has_results_;
};

}  // namespace

Result<void> read_methods(const TomlReader& toml, const toml::table& root,
                          const PlanVocabulary& vocabulary, Plan& plan) {
  SPOOL_ASSIGN(plan.samplers,
               MethodReader(toml, vocabulary.samplers, vocabulary.has_results).read(root));
  SPOOL_ASSIGN(plan.filters,
               MethodReader(toml, vocabulary.filters, vocabulary.has_results).read(root));
  return {};
}

}  // namespace spool
