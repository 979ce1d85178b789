// Options of a method as one table: name, meaning, allowed values, and how to read and write them.
//
// A method keeps its options in a plain struct with defaults, and describes them once with a table.
// Setting by name (--set NAME=VALUE), --help, `spool list` and the run log all read that table, so
// they cannot drift apart.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/nearest_name.h"

namespace spool {

template <class Options>
struct Option {
  std::string name;
  std::string allowed;  // "paper|robust", "0 .. 1"
  std::string help;
  std::function<Result<void>(Options&, std::string_view)> set;
  std::function<std::string(const Options&)> get;
  bool expert = false;  // a reading of the text, or a detail: shown where all are asked for
};

template <class Options>
Option<Options> expert(Option<Options> option) {
  option.expert = true;
  return option;
}

template <class Options>
using OptionTable = std::vector<Option<Options>>;

// "a = 1, b = 2": reads a number in [lowest, highest]; "inf" is allowed where highest is infinite.
Result<double> parse_number(std::string_view name, std::string_view text, double lowest,
                            double highest);
Result<int> parse_integer(std::string_view name, std::string_view text, int lowest, int highest);
std::string format_number(double value);  // shortest text that reads back the same
std::string number_range(double lowest, double highest);

template <class Options>
Option<Options> number_option(std::string name, double Options::* member, double lowest,
                              double highest, std::string help) {
  return {name, number_range(lowest, highest), std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            SPOOL_ASSIGN(const double value, parse_number(name, text, lowest, highest));
            options.*member = value;
            return {};
          },
          [=](const Options& options) { return format_number(options.*member); }};
}

template <class Options>
Option<Options> integer_option(std::string name, int Options::* member, int lowest, int highest,
                               std::string help) {
  return {name, fmt::format("{} .. {}", lowest, highest), std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            SPOOL_ASSIGN(const int value, parse_integer(name, text, lowest, highest));
            options.*member = value;
            return {};
          },
          [=](const Options& options) { return std::to_string(options.*member); }};
}

// An option that is a whole number or a word that stands for "decide yourself".
template <class Options>
Option<Options> integer_or_word_option(std::string name, std::optional<int> Options::* member,
                                       std::string word, int lowest, int highest,
                                       std::string help) {
  return {name, fmt::format("{}|{} .. {}", word, lowest, highest), std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            if (text == word) {
              (options.*member).reset();
              return {};
            }
            const Result<int> value = parse_integer(name, text, lowest, highest);
            if (!value) {
              return fail(ErrorCode::kUsage, "option {}: '{}' is neither {} nor {} .. {}", name,
                          text, word, lowest, highest);
            }
            options.*member = *value;
            return {};
          },
          [=](const Options& options) {
            return options.*member ? std::to_string(*(options.*member)) : word;
          }};
}

template <class Options, class Enum>
Option<Options> choice_option(std::string name, Enum Options::* member,
                              std::vector<std::pair<std::string, Enum>> choices, std::string help) {
  std::string allowed;
  for (const auto& choice : choices)
    allowed += (allowed.empty() ? "" : "|") + choice.first;
  return {name, allowed, std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            for (const auto& choice : choices) {
              if (choice.first == text) {
                options.*member = choice.second;
                return {};
              }
            }
            return fail(ErrorCode::kUsage, "option {}: '{}' is not one of {}", name, text, allowed);
          },
          [=](const Options& options) -> std::string {
            for (const auto& choice : choices) {
              if (choice.second == options.*member) return choice.first;
            }
            return "?";
          }};
}

template <class Options>
Option<Options> switch_option(std::string name, bool Options::* member, std::string help) {
  return choice_option<Options, bool>(std::move(name), member, {{"on", true}, {"off", false}},
                                      std::move(help));
}

// Appends the options of a struct that is a member of Outer, under their own names.
template <class Outer, class Inner>
void append_options(OptionTable<Outer>& table, const OptionTable<Inner>& inner,
                    Inner Outer::* member) {
  for (const Option<Inner>& option : inner) {
    table.push_back(
        {option.name, option.allowed, option.help,
         [set = option.set, member](Outer& options, std::string_view text) {
           return set(options.*member, text);
         },
         [get = option.get, member](const Outer& options) { return get(options.*member); },
         option.expert});
  }
}

// Sets options by name; an unknown name is an error that says the nearest known one.
template <class Options>
Result<void> set_option(const OptionTable<Options>& table, Options& options, std::string_view name,
                        std::string_view value) {
  for (const auto& option : table) {
    if (option.name == name) return option.set(options, value);
  }
  return fail(ErrorCode::kUsage, "{}", unknown_name("option", name, names_of(table)));
}

using OptionValues = std::vector<std::pair<std::string, std::string>>;

template <class Options>
OptionValues option_values(const OptionTable<Options>& table, const Options& options) {
  OptionValues values;
  for (const auto& option : table)
    values.emplace_back(option.name, option.get(options));
  return values;
}

// One option as people see it; `value` is that of the options described.
struct OptionDescription {
  std::string name, allowed, help, value;
  bool expert = false;
};

template <class Options>
std::vector<OptionDescription> describe_options(const OptionTable<Options>& table,
                                                const Options& options) {
  std::vector<OptionDescription> descriptions;
  for (const auto& option : table) {
    descriptions.push_back(
        {option.name, option.allowed, option.help, option.get(options), option.expert});
  }
  return descriptions;
}

// Applies NAME=VALUE pairs in order.
template <class Options>
Result<Options> with_options(const OptionTable<Options>& table, Options options,
                             const OptionValues& set) {
  for (const auto& [name, value] : set)
    SPOOL_TRY(set_option(table, options, name, value));
  return options;
}

}  // namespace spool
