#include "tools/command_line/misspelt.h"

#include <vector>

#include <fmt/ranges.h>

#include "lib/core/option_table.h"
#include "lib/exchange/foreign_formats.h"
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

// What CLI11 found, in the program's words.
std::string in_our_words(const CLI::App& at, const CLI::ParseError& error) {
  if (const std::string empty = empty_option(at); !empty.empty())
    return empty + ": is empty: give a value or leave it out";
  const std::string text = error.what();
  for (const CLI::Option* option : at.get_options()) {
    const std::string name = option->get_name();
    if (dynamic_cast<const CLI::RequiredError*>(&error) && text == name + " is required")
      return fmt::format("{} ({})", text, option->get_description());
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) && text.starts_with(name + ": At Most"))
      return name + ": given more than once: give it once, several values with commas between them";
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error))
    return fmt::format("{}: more than the verb takes", fmt::join(at.remaining(true), " "));
  return text;
}

}  // namespace

std::string explain(const CLI::App& app, const CLI::ParseError& error, int count,
                    char** arguments) {
  const CLI::App* verb = nullptr;
  for (const CLI::App* parsed : app.get_subcommands())
    verb = parsed;
  if (!verb && count > 1 && arguments[1][0] != '-') {
    return unknown_name("verb", arguments[1], known_words(app, false)) + ": see spool --help";
  }
  const CLI::App& at = verb ? *verb : app;
  const std::string help = verb ? "spool " + verb->get_name() + " --help" : "spool --help";
  for (const std::string& word : app.remaining(true)) {
    if (word.rfind("--", 0) != 0) continue;
    const std::string name = word.substr(0, word.find('='));
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
