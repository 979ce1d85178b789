#include "tools/command_line/help_text.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/command_line/program.h"
#include "tools/terminal/text_columns.h"

namespace spool::tools {
namespace {

constexpr std::size_t kPlainWidth = 80;  // where no terminal says how wide it is
constexpr std::size_t kWidest = 110;     // longer lines are hard to read
constexpr std::size_t kColumn = 26;      // of names; a longer one has a line of its own

constexpr const char* kWhatItIs =
    "Spool records every sample of a rendered image once, replays adaptive samplers on the "
    "recording, filters, and reports error and time.";
constexpr const char* kStart =
    "Start:\n"
    "  spool synth scene_s --size 64 --samples 64 -o s.spool\n"
    "  spool evaluate s.spool --samplers uniform,multiscale \\\n"
    "    --filters box,directional --spp 4,8 -o results\n"
    "  spool report results -o report.html\n";
constexpr const char* kExamples = "Examples:\n";

const std::pair<const char*, std::vector<const char*>> kGroups[] = {
    {"Look", {"info", "check", "picture", "pixel", "show", "view"}},
    {"Record", {"synth", "pack", "convert", "recover"}},
    {"One image", {"replay", "reconstruct", "metrics"}},
    {"Compare methods", {"evaluate", "compare", "report", "figure"}},
    {"More", {"list", "completion", "man"}}};

std::size_t help_width() {
  const std::size_t width = line_width();
  return width == 0 ? kPlainWidth : std::min(width, kWidest);
}

// "  NAME    what it is", the text in a column of its own.
std::string entry(const std::string& name, const std::string& text,
                  std::size_t wanted_column = kColumn) {
  const std::string start = "  " + name;
  const std::size_t column = help_width() < 2 * wanted_column ? 8 : wanted_column;
  std::istringstream lines(wrapped(text, help_width() - column));
  std::string shown, line;
  if (start.size() + 2 > column) shown = start + "\n";
  for (bool first = shown.empty(); std::getline(lines, line); first = false)
    shown += fmt::format("{:<{}}{}\n", first ? start : "", column, line);
  return shown;
}

std::string value_of(const CLI::Option& option) {
  if (!option.get_option_text().empty()) return option.get_option_text();
  if (option.get_items_expected_max() == 0) return "";
  const std::vector<std::string> choices = written_choices(option);
  if (!choices.empty()) return fmt::format("{}", fmt::join(choices, "|"));
  const std::string type = option.get_type_name();  // what CLI11 checks stands behind a colon
  return type.substr(0, type.find(':'));
}

std::string option_entry(const CLI::Option& option) {
  const bool positional = option.get_positional();
  std::string name = positional ? option.get_name(true, false) : option.get_name(false, true);
  if (!positional && !value_of(option).empty()) name += " " + value_of(option);
  std::string text = option.get_description();
  for (const CLI::Option* other : option.get_excludes())
    text += fmt::format("; not with {}", other->get_name());
  return entry(name, text + (option.get_required() && !positional ? " (required)" : ""));
}

// Groups in the order in which the options were added, what every verb has last.
std::string options_text(const CLI::App& verb) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_positional() ? "" : option->get_group();
    auto group = std::ranges::find(groups, name, &std::pair<std::string, std::string>::first);
    if (group == groups.end()) group = groups.insert(groups.end(), {name, ""});
    group->second += option_entry(*option);
  }
  const auto rank = [](const auto& group) {
    return group.first.empty() ? 0 : group.first == "Common" ? 2 : 1;
  };
  std::ranges::stable_sort(groups, {}, rank);
  std::string text;
  for (const auto& [name, entries] : groups)
    text += (name.empty() ? "" : "\n" + name + ":\n") + entries;
  return text;
}

// The first command of examples, which may go over several lines, and the others.
std::pair<std::string, std::string> first_example(const std::string& examples) {
  std::size_t end = examples.find('\n');
  while (end != std::string::npos && examples[end - 1] == '\\')
    end = examples.find('\n', end + 1);
  if (end == std::string::npos) return {examples + "\n", ""};
  return {examples.substr(0, end + 1), examples.substr(end + 1)};
}

std::string usage(const CLI::App& verb) {
  std::string text = "Usage: spool " + verb.get_name() + " [OPTIONS]";
  for (const CLI::Option* option : verb.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name =
        option->get_name() + (option->get_items_expected_max() > 1 ? "..." : "");
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

// The footer of a verb: what else to know, and its examples.
std::string verb_help(const CLI::App& verb) {
  const std::string footer = verb.get_footer();
  const std::size_t at = footer.find(kExamples);
  const std::string notes = footer.substr(0, at);
  const auto [first, others] = first_example(
      at == std::string::npos ? "" : footer.substr(at + std::string(kExamples).size()));
  std::string text =
      wrapped(fmt::format("spool {}: {}", verb.get_name(), verb.get_description()), help_width()) +
      "\n\n" + first + "\n" + usage(verb) + options_text(verb);
  if (!notes.empty()) text += "\n" + wrapped(notes, help_width());
  if (!others.empty()) text += "\n" + std::string("More examples:\n") + others + "\n";
  return text;
}

class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string /*name*/,
                        CLI::AppFormatMode /*mode*/) const override {
    if (app->get_parent()) return verb_help(*app);
    return greeting(*app) + options_text(*app) + "\n" + wrapped(app->get_footer(), help_width()) +
           "\n";
  }
};

}  // namespace

void group_verbs(CLI::App& app) {
  for (const auto& [group, verbs] : kGroups) {
    for (const char* verb : verbs)
      app.get_subcommand(verb)->group(group);
  }
}

std::string greeting(const CLI::App& app) {
  std::string text = wrapped(kWhatItIs, help_width()) + "\n\n" + kStart;
  for (const auto& [group, verbs] : kGroups) {
    text += "\n" + std::string(group) + ":\n";
    for (const char* verb : verbs)
      text += entry(verb, app.get_subcommand(verb)->get_description(), 15);
  }
  return text + "\nOf each verb, with examples: spool VERB --help\n";
}

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  return std::make_shared<HelpFormatter>();
}

}  // namespace spool::tools
