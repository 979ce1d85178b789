#include "tools/command_line/misspelt.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <fmt/ranges.h>

#include "lib/core/option_table.h"
#include "lib/exchange/foreign_formats.h"
#include "tools/command_line/manual.h"
#include "tools/verbs/foreign_settings.h"

namespace spool::tools {
namespace {

// Names of `app`'s verbs or long options, for a hint after a misspelt word.
std::vector<std::string> known_words(const CLI::App& app, bool options) {
  std::vector<std::string> words;
  if (options) {
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames())
        words.push_back("--" + name);
    }
  } else {
    for (const CLI::App* verb : app.get_subcommands({}))
      words.push_back(verb->get_name());
  }
  return words;
}

// "0 .. 1024" (within()), or nothing.
std::string range_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.find(" .. ") == std::string::npos ? "" : type;
}

// Why the option cannot have the value that was given, and what it may have; empty where CLI11's
// own text is this program's (seed_check).
std::string wrong_value(const CLI::App& verb, const CLI::Option& option) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const std::string name = option.get_name(), range = range_of(option);
  const std::string value = fmt::format("{}", fmt::join(option.results(), ","));
  if (option.get_items_expected_max() == 0) return name + ": takes no value";
  if (const auto choices = choices_of(verb.get_name(), option); !choices.empty())
    return fmt::format("{}: '{}' is not one of {}{}", name, value, fmt::join(choices, "|"),
                       did_you_mean(value, choices));
  if (range.empty()) return "";
  return fmt::format("{}: '{}' is not a {}number in {}", name, value,
                     parse_number(name, value, -kAny, kAny) ? "whole " : "", range);
}

// What CLI11 found, in the program's words.
std::string in_our_words(const CLI::App& at, const CLI::ParseError& error) {
  if (const std::string empty = empty_option(at); !empty.empty())
    return empty + ": is empty: give a value or leave it out";
  const std::string text = error.what();
  for (const CLI::Option* option : at.get_options()) {
    const std::string name = option->get_name();
    if (dynamic_cast<const CLI::RequiredError*>(&error) && text == name + " is required")
      return fmt::format("{} ({})", text, option->get_description());
    if (text.starts_with(name + ": At Most"))
      return name + ": given more than once: give it once, several values with commas between them";
    if (text.starts_with(name + ": 1 required"))
      return fmt::format("{}: needs a value{}{} ({})", name, range_of(*option).empty() ? "" : ", ",
                         range_of(*option), option->get_description());
    if (text.starts_with(name + ": ") || text.starts_with("Could not convert: " + name + " = "))
      if (const std::string wrong = wrong_value(at, *option); !wrong.empty()) return wrong;
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error))
    return fmt::format("{}: more than the verb takes", fmt::join(at.remaining(true), " "));
  return at.get_parent() ? text : "a verb is needed";
}

}  // namespace

std::string explain(const CLI::App& app, const CLI::ParseError& error, int count,
                    char** arguments) {
  const CLI::App* verb = nullptr;
  for (const CLI::App* parsed : app.get_subcommands())
    verb = parsed;
  const CLI::App& at = verb ? *verb : app;
  const std::string help = verb ? "spool " + verb->get_name() + " --help" : "spool --help";
  const std::vector<std::string> verbs = known_words(app, false);
  const std::string first = arguments[count > 1 ? 1 : 0];
  if (!first.starts_with('-') && std::ranges::find(verbs, first) == verbs.end())
    return fmt::format("{}: see {}", unknown_name("verb", first, verbs), help);
  for (const std::string& word : app.remaining(true)) {
    if (!word.starts_with('-') || word == "-") continue;
    const std::string name = word.substr(0, word.find('='));
    if (verb && verb->get_option_no_throw(name))
      return fmt::format("{}: write it behind the verb: see {}", name, help);
    const std::string of = verb ? verb->get_name() : "";
    const std::string now =
        of == "pack"      ? setting_of_flag("import", name, exchange::import_formats())
        : of == "convert" ? setting_of_flag("export", name, exchange::export_formats())
                          : "";
    if (!now.empty())
      return fmt::format("unknown option '{}': write --set {}: see spool list {}s", word, now,
                         now.substr(0, now.find('.')));
    return fmt::format("{}: see {}", unknown_name("option", name, known_words(at, true)), help);
  }
  return fmt::format("{}: see {}", in_our_words(at, error), help);
}

}  // namespace spool::tools
