#include "tools/methods/method_settings.h"

#include <algorithm>
#include <utility>

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

// One kind of method (samplers or filters) being put together for a command.
template <class Function>
struct Choices {
  std::string kind;  // "sampler", "filter"
  std::vector<const Method<Function>*> methods;
  std::vector<MethodChoice> choices;  // one per method

  static Result<Choices> of(const MethodList<Function>& known,
                            const std::vector<std::string>& texts) {
    Choices all{known.kind, {}, {}};
    for (const std::string& text : texts) {
      SPOOL_ASSIGN(MethodChoice choice, choose_method(known, text));
      all.methods.push_back(find_method(known, choice.name));
      all.choices.push_back(std::move(choice));
    }
    return all;
  }

  bool reaches(const Setting& setting, const Method<Function>& method) const {
    return setting.part == method.name || setting.part == kind;
  }

  // The settings meant for `method`: all of them when it is alone or named, else those it has.
  OptionValues values_for(const Method<Function>& method, std::vector<Setting>& settings) const {
    const std::vector<std::string> known = names_of(method.describe(""));
    OptionValues values;
    for (Setting& setting : settings) {
      if (!reaches(setting, method)) continue;
      const bool strict = methods.size() == 1 || setting.part == method.name;
      if (!strict && std::ranges::find(known, setting.option) == known.end()) continue;
      setting.used = true;
      values.emplace_back(setting.option, setting.value);
    }
    return values;
  }
};

// A method's own preset goes before the command's; its own options stand last and win.
template <class Function>
Result<std::vector<ChosenMethod<Function>>> choose(const MethodList<Function>& known,
                                                   const Choices<Function>& wanted,
                                                   const std::string& preset,
                                                   std::vector<Setting>& settings) {
  std::vector<ChosenMethod<Function>> chosen;
  for (std::size_t i = 0; i < wanted.methods.size(); ++i) {
    const Method<Function>& method = *wanted.methods[i];
    MethodChoice choice = wanted.choices[i];
    choice.set = wanted.values_for(method, settings);
    const OptionValues& own = wanted.choices[i].set;
    choice.set.insert(choice.set.end(), own.begin(), own.end());
    const bool has_preset = std::ranges::find(method.presets, preset) != method.presets.end();
    if (choice.preset.empty() && has_preset) choice.preset = preset;
    SPOOL_ASSIGN(Ready<Function> ready, make_method(known, choice));
    chosen.push_back({std::move(choice), &method, std::move(ready)});
  }
  std::vector<MethodChoice> choices = choices_of(chosen);
  SPOOL_TRY(check_distinct(known.kind, choices));
  label_commands(known, choices);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i].choice.own_label = choices[i].own_label;
  return chosen;
}

template <class Function>
void collect_presets(const Choices<Function>& wanted, std::vector<std::string>& presets) {
  for (const Method<Function>* method : wanted.methods)
    presets.insert(presets.end(), method->presets.begin(), method->presets.end());
}

Result<void> check_preset(const std::string& preset, const std::vector<std::string>& known) {
  if (preset.empty() || std::ranges::find(known, preset) != known.end()) return {};
  if (known.empty()) {
    return fail(ErrorCode::kUsage, "--preset {}: none of these methods has presets", preset);
  }
  return fail(ErrorCode::kUsage, "--preset {}: unknown{}: see spool list presets", preset,
              did_you_mean(preset, known));
}

// Options that are no method's: the settings of `part`.
template <class Options>
Result<Options> make_options(std::string_view part, const OptionTable<Options>& table,
                             std::vector<Setting>& settings) {
  Options options;
  for (Setting& setting : settings) {
    if (setting.part != part) continue;
    setting.used = true;
    const Result<void> set = set_option(table, options, setting.option, setting.value);
    if (!set)
      return fail(ErrorCode::kUsage, "--set {}: {}: see spool list {}", setting.text,
                  set.error().message, part);
  }
  return options;
}

// Why nothing took `setting`: its part names no method of this command, or no method has the
// option.
Error unused(const Setting& setting, const Choices<SamplerFunction>& samplers,
             const Choices<FilterFunction>& filters) {
  std::vector<std::string> parts = {"pool", "metrics"};
  std::vector<std::string> options;
  const auto add = [&](const auto& wanted) {
    if (!wanted.methods.empty()) parts.push_back(wanted.kind);
    for (const auto* method : wanted.methods) {
      parts.push_back(method->name);
      if (!wanted.reaches(setting, *method)) continue;
      for (const std::string& option : names_of(method->describe("")))
        options.push_back(option);
    }
  };
  add(samplers);
  add(filters);
  const bool part_known = std::ranges::find(parts, setting.part) != parts.end();
  return {ErrorCode::kUsage,
          fmt::format("--set {}: {} '{}'{}", setting.text,
                      part_known ? "no method here has an option" : "no method here is called",
                      part_known ? setting.option : setting.part,
                      part_known ? did_you_mean(setting.option, options)
                                 : did_you_mean(setting.part, parts))};
}

// `filters_beside` returns the names of the filters, once the samplers are made.
template <class FiltersBeside>
Result<Methods> choose_beside(const std::vector<std::string>& sampler_names,
                              const FiltersBeside& filters_beside, const MethodOptions& options) {
  SPOOL_ASSIGN(std::vector<Setting> settings, parse_settings(options.settings));
  SPOOL_ASSIGN(const auto samplers, Choices<SamplerFunction>::of(known_samplers(), sampler_names));
  Methods methods;
  SPOOL_ASSIGN(methods.samplers, choose(known_samplers(), samplers, options.preset, settings));
  SPOOL_ASSIGN(const auto filters,
               Choices<FilterFunction>::of(known_filters(), filters_beside(methods.samplers)));
  SPOOL_ASSIGN(methods.filters, choose(known_filters(), filters, options.preset, settings));
  std::vector<std::string> presets;
  collect_presets(samplers, presets);
  collect_presets(filters, presets);
  SPOOL_TRY(check_preset(options.preset, presets));
  SPOOL_ASSIGN(methods.rules, make_options("pool", sanitise_option_table(), settings));
  SPOOL_ASSIGN(methods.metrics, make_options("metrics", metric_option_table(), settings));
  for (const Setting& setting : settings) {
    if (!setting.used) return tl::unexpected<Error>(unused(setting, samplers, filters));
  }
  return methods;
}

}  // namespace

Result<Methods> choose_methods(const std::vector<std::string>& sampler_names,
                               const std::vector<std::string>& filter_names,
                               const MethodOptions& options) {
  return choose_beside(sampler_names, [&](const auto&) { return filter_names; }, options);
}

Result<Methods> choose_with_loop_filter(const std::string& sampler_name,
                                        const std::string& filter_name,
                                        const MethodOptions& options) {
  const auto in_loop = [&](const std::vector<ChosenMethod<SamplerFunction>>& samplers) {
    const std::string& name =
        filter_name.empty() ? samplers[0].ready.needs.loop_filter : filter_name;
    return name.empty() ? std::vector<std::string>{} : std::vector{name};
  };
  SPOOL_ASSIGN(Methods methods, choose_beside({sampler_name}, in_loop, options));
  const ChosenMethod<SamplerFunction>& sampler = methods.samplers[0];
  if (!filter_name.empty() && !sampler.ready.needs.filter_in_loop) {
    return fail(ErrorCode::kUsage,
                "{} has no filter in its loop, as filtered_halves and cross_halves have: leave {} "
                "out",
                sampler.choice.label(), filter_name);
  }
  return methods;
}

}  // namespace spool::tools
