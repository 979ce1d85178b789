#include "tools/methods/method_settings.h"

#include <algorithm>
#include <set>
#include <utility>

#include "tools/console.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

struct Setting {
  std::string text, part, option, value;
  bool used = false;
};

Result<std::vector<Setting>> parse_settings(const std::vector<std::string>& texts) {
  std::vector<Setting> settings;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::size_t dot = text.find('.');
    if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0) {
      return fail(ErrorCode::kUsage,
                  "--set {}: write PART.OPTION=VALUE, for example sampler.alpha=0.3", text);
    }
    settings.push_back({text, text.substr(0, dot), text.substr(dot + 1, equals - dot - 1),
                        text.substr(equals + 1)});
  }
  return settings;
}

template <class Entry>
Result<const Entry*> find_entry(const std::vector<Entry>& entries, std::string_view kind,
                                const std::string& name) {
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (entry.name == name) return &entry;
    names.push_back(entry.name);
  }
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::kUsage, "unknown {} '{}'{}: see spool list {}s", kind, name,
              near.empty() ? "" : fmt::format(", did you mean '{}'?", near), kind);
}

// "NAME", "NAME:PRESET", "NAME{a=1,b=2}", "NAME:PRESET{a=1}", or "NAME:ARGUMENT" for methods that
// take one, whatever the argument holds.
struct MethodText {
  std::string name, preset;
  OptionValues set;
};

template <class Entry>
Result<MethodText> parse_method(const std::vector<Entry>& entries, const std::string& text) {
  MethodText method;
  method.name = text.substr(0, text.find_first_of(":{"));
  std::string rest = text.substr(method.name.size());
  for (const Entry& entry : entries) {
    if (entry.name != method.name || entry.argument.empty()) continue;
    if (rest.starts_with(':')) method.preset = rest.substr(1);
    if (!method.preset.empty()) return method;
    return fail(ErrorCode::kUsage, "{}: write {}:{}", text, entry.name, entry.argument);
  }
  if (const std::size_t brace = rest.find('{'); brace != std::string::npos) {
    if (!rest.ends_with('}')) {
      return fail(ErrorCode::kUsage, "{}: the brace is not closed: write {}{{OPTION=VALUE}}", text,
                  method.name);
    }
    for (const std::string& part : split_list(rest.substr(brace + 1, rest.size() - brace - 2))) {
      const std::size_t equals = part.find('=');
      if (equals == std::string::npos || equals == 0) {
        return fail(ErrorCode::kUsage, "{}: '{}' is no OPTION=VALUE", text, part);
      }
      method.set.emplace_back(part.substr(0, equals), part.substr(equals + 1));
    }
    rest = rest.substr(0, brace);
  }
  if (!rest.empty()) method.preset = rest.substr(1);
  return method;
}

// One kind of method (samplers or filters) being put together for a command.
template <class Entry>
struct Choice {
  std::string kind;  // "sampler", "filter"
  std::vector<const Entry*> entries;
  std::vector<MethodText> texts;  // one per entry

  static Result<Choice> of(std::string kind, const std::vector<Entry>& all,
                           const std::vector<std::string>& names) {
    Choice choice{std::move(kind), {}, {}};
    for (const std::string& name : names) {
      SPOOL_ASSIGN(MethodText text, parse_method(all, name));
      SPOOL_ASSIGN(const Entry* entry, find_entry(all, choice.kind, text.name));
      choice.entries.push_back(entry);
      choice.texts.push_back(std::move(text));
    }
    return choice;
  }

  bool reaches(const Setting& setting, const Entry& entry) const {
    return setting.part == entry.name || setting.part == kind;
  }

  // The settings meant for `entry`: all of them when it is alone or named, else those it has.
  OptionValues values_for(const Entry& entry, std::vector<Setting>& settings) const {
    std::set<std::string> known;
    for (const OptionDescription& option : entry.describe(""))
      known.insert(option.name);
    OptionValues values;
    for (Setting& setting : settings) {
      if (!reaches(setting, entry)) continue;
      const bool strict = entries.size() == 1 || setting.part == entry.name;
      if (!strict && !known.contains(setting.option)) continue;
      setting.used = true;
      values.emplace_back(setting.option, setting.value);
    }
    return values;
  }
};

template <class Entry>
bool has_preset(const Entry& entry, const std::string& preset) {
  return std::ranges::find(entry.presets, preset) != entry.presets.end();
}

// A method's own preset goes before the command's; its own options stand last and win.
template <class Entry>
Result<std::vector<MethodChoice>> choose(const Choice<Entry>& choice, const std::string& preset,
                                         std::vector<Setting>& settings) {
  std::vector<MethodChoice> chosen;
  for (std::size_t i = 0; i < choice.entries.size(); ++i) {
    const Entry& entry = *choice.entries[i];
    const MethodText& text = choice.texts[i];
    MethodChoice method{entry.name, text.preset, choice.values_for(entry, settings)};
    if (method.preset.empty() && has_preset(entry, preset)) method.preset = preset;
    method.set.insert(method.set.end(), text.set.begin(), text.set.end());
    SPOOL_TRY(entry.make(method.preset, method.set));  // wrong values are found before any work
    chosen.push_back(std::move(method));
  }
  return chosen;
}

template <class Entry>
void collect_presets(const Choice<Entry>& choice, std::vector<std::string>& presets) {
  for (const Entry* entry : choice.entries) {
    presets.insert(presets.end(), entry->presets.begin(), entry->presets.end());
  }
}

Result<void> check_preset(const std::string& preset, const std::vector<std::string>& known) {
  if (preset.empty() || std::ranges::find(known, preset) != known.end()) return {};
  if (known.empty()) {
    return fail(ErrorCode::kUsage, "--preset {}: none of these methods has presets", preset);
  }
  const std::string near = nearest_name(preset, known);
  return fail(ErrorCode::kUsage, "--preset {}: unknown{}: see spool list presets", preset,
              near.empty() ? "" : fmt::format(", did you mean '{}'?", near));
}

// Options that are no method's: the settings of `part`.
template <class Options>
Result<Options> make_options(std::string_view part, const OptionTable<Options>& table,
                             std::vector<Setting>& settings) {
  Options options;
  for (Setting& setting : settings) {
    if (setting.part != part) continue;
    setting.used = true;
    SPOOL_TRY(set_option(table, options, setting.option, setting.value));
  }
  return options;
}

// Why nothing took `setting`: its part names no method of this command, or no method has the
// option.
Error unused(const Setting& setting, const Choice<SamplerEntry>& samplers,
             const Choice<ReconstructorEntry>& filters) {
  std::vector<std::string> parts = {"pool", "metrics"};
  std::vector<std::string> options;
  const auto add = [&](const auto& choice) {
    if (!choice.entries.empty()) parts.push_back(choice.kind);
    for (const auto* entry : choice.entries) {
      parts.push_back(entry->name);
      if (!choice.reaches(setting, *entry)) continue;
      for (const OptionDescription& option : entry->describe(""))
        options.push_back(option.name);
    }
  };
  add(samplers);
  add(filters);
  const bool part_known = std::ranges::find(parts, setting.part) != parts.end();
  const std::string near =
      part_known ? nearest_name(setting.option, options) : nearest_name(setting.part, parts);
  return {ErrorCode::kUsage,
          fmt::format("--set {}: {} '{}'{}", setting.text,
                      part_known ? "no method here has an option" : "no method here is called",
                      part_known ? setting.option : setting.part,
                      near.empty() ? "" : fmt::format(", did you mean '{}'?", near))};
}

// A method by its choice; the name may be written in full, "multiscale:paper" or "exec:COMMAND".
template <class Entry>
auto make_method(const std::vector<Entry>& entries, std::string_view kind,
                 const MethodChoice& choice) -> decltype(entries[0].make("", {})) {
  MethodText text{choice.name, choice.preset, {}};
  if (choice.preset.empty()) {
    SPOOL_ASSIGN(text, parse_method(entries, choice.name));
  }
  text.set.insert(text.set.end(), choice.set.begin(), choice.set.end());
  SPOOL_ASSIGN(const Entry* entry, find_entry(entries, kind, text.name));
  return entry->make(text.preset, text.set);
}

}  // namespace

Result<Methods> choose_methods(const std::vector<std::string>& sampler_names,
                               const std::vector<std::string>& filter_names,
                               const MethodOptions& options) {
  SPOOL_ASSIGN(std::vector<Setting> settings, parse_settings(options.settings));
  SPOOL_ASSIGN(const auto sampler_choice,
               Choice<SamplerEntry>::of("sampler", known_samplers(), sampler_names));
  SPOOL_ASSIGN(const auto filter_choice,
               Choice<ReconstructorEntry>::of("filter", known_filters(), filter_names));
  std::vector<std::string> presets;
  collect_presets(sampler_choice, presets);
  collect_presets(filter_choice, presets);
  SPOOL_TRY(check_preset(options.preset, presets));
  Methods methods;
  SPOOL_ASSIGN(methods.samplers, choose(sampler_choice, options.preset, settings));
  SPOOL_ASSIGN(methods.filters, choose(filter_choice, options.preset, settings));
  SPOOL_ASSIGN(methods.rules, make_options("pool", sanitise_option_table(), settings));
  SPOOL_ASSIGN(methods.metrics, make_options("metrics", metric_option_table(), settings));
  for (const Setting& setting : settings) {
    if (!setting.used) return tl::unexpected<Error>(unused(setting, sampler_choice, filter_choice));
  }
  return methods;
}

Result<SamplerFunction> make_sampler(const MethodChoice& choice) {
  return make_method(known_samplers(), "sampler", choice);
}

Result<ReconstructorFunction> make_filter(const MethodChoice& choice) {
  return make_method(known_filters(), "filter", choice);
}

std::vector<std::string> split_methods(std::string_view text) {
  std::vector<std::string> methods(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '{') {
      ++depth;
    } else if (c == '}') {
      --depth;
    } else if (c == ',' && depth <= 0) {
      methods.emplace_back();
      continue;
    }
    methods.back() += c;
  }
  std::erase_if(methods, [](const std::string& method) { return method.empty(); });
  return methods;
}

}  // namespace spool::tools
