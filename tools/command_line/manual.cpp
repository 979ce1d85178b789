#include "tools/command_line/manual.h"

#include <algorithm>
#include <string>
#include <vector>

#include "lib/core/option_table.h"
#include "lib/exchange/foreign_formats.h"
#include "lib/experiment/reference.h"
#include "lib/experiment/result_record.h"
#include "lib/filters/filters.h"
#include "lib/metrics/error_metrics.h"
#include "lib/sampling/samplers.h"
#include "lib/synthetic/synthetic_scenes.h"

namespace spool::tools {
namespace {

std::vector<std::string> names_of_presets() {
  std::vector<std::string> names;
  const auto add = [&](const auto& methods) {
    for (const auto& method : methods) {
      for (const std::string& preset : method.presets)
        if (std::ranges::find(names, preset) == names.end()) names.push_back(preset);
    }
  };
  add(samplers());
  add(filters());
  return names;
}

// Values that CLI11 does not know: names of methods and scenes.
std::vector<std::string> known_names(const std::string& verb, const CLI::Option& option) {
  const std::string& name = option.get_single_name();
  if (name == "sampler" || name == "samplers") return names_of(samplers());
  if (name == "filter" || name == "filters") return names_of(filters());
  if (verb == "pack" && name == "from") {
    std::vector<std::string> kinds = names_of(exchange::import_formats());
    kinds.insert(kinds.begin(), "passes");
    return kinds;
  }
  if (name == "preset") return names_of_presets();
  if (name == "metric" && verb == "compare") return compared_metrics();
  if (name == "metric") return names_of(metrics());
  if (verb == "evaluate" && name == "reference") return names_of(reference_kinds());
  if (verb == "convert" && name == "to") return names_of(exchange::export_formats());
  if (verb == "list" && name == "WHAT") return lists();
  if (verb == "synth" && name == "NAME") {
    std::vector<std::string> scenes;
    for (const SyntheticEntry& scene : synthetic_scenes())
      scenes.push_back(scene.name);
    return scenes;
  }
  return {};
}

OptionText text_of(const std::string& verb, const CLI::Option& option) {
  OptionText text;
  if (option.get_positional()) {
    text.names = {option.get_single_name()};
  } else {
    for (const std::string& name : option.get_snames())
      text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
      text.names.push_back("--" + name);
    const std::string type = option.get_type_name();
    if (option.get_items_expected_max() > 0) text.value = type.substr(0, type.find_first_of(":{"));
    if (option.get_items_expected_max() > 0 && text.value.empty()) text.value = "VALUE";
  }
  text.help = option.get_description();
  text.choices = choices_of(verb, option);
  text.required = option.get_required();
  text.several = option.get_items_expected_max() > 1 ||
                 option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return text;
}

// What the program is, for its own completions and manual pages.
ProgramText text_of(const CLI::App& app) {
  ProgramText program{app.get_name(), SPOOL_VERSION, app.get_description(), app.get_footer(), {}};
  for (const CLI::App* verb : app.get_subcommands({})) {
    VerbText text{verb->get_name(), verb->get_description(), verb->get_footer(), {}, {}};
    for (const CLI::Option* option : verb->get_options())
      (option->get_positional() ? text.arguments : text.options)
          .push_back(text_of(text.name, *option));
    program.verbs.push_back(std::move(text));
  }
  const std::vector<std::string> verbs = names_of(program.verbs);
  for (VerbText& verb : program.verbs)
    if (verb.name == "man") verb.arguments.front().choices = verbs;
  return program;
}

}  // namespace

std::vector<std::string> choices_of(const std::string& verb, const CLI::Option& option) {
  const std::vector<std::string> names = known_names(verb, option);
  return names.empty() ? written_choices(option) : names;
}

void add_completion(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "completion", "a script by which a shell completes verbs, options and names of methods");
  verb.add_option("SHELL", program.completion.shell, "the shell that will read it")
      ->required()
      ->check(CLI::IsMember(completion_shells()));
  verb.footer(
      "Installed packages bring theirs along.\n"
      "Examples:\n"
      "  source <(spool completion bash)\n"
      "  spool completion zsh > ~/.zfunc/_spool\n"
      "  spool completion fish > ~/.config/fish/completions/spool.fish");
  verb.callback([&] {
    program.chosen = [&] { return run_completion(program.completion, text_of(program.app)); };
  });
}

void add_man(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("man", "the manual page of the program or of a verb, for man(1)");
  verb.add_option("VERB", program.man.verb, "that verb's page; without it the program's own");
  verb.add_option("-o,--output", program.man.output, "a folder for all pages: NAME.1");
  add_common(verb, program.common, false, true);
  verb.footer(
      "Installed packages bring theirs along: man spool, man spool-evaluate.\n"
      "Examples:\n"
      "  spool man evaluate | man -l -\n"
      "  spool man -o ~/.local/share/man/man1");
  verb.callback([&] {
    program.chosen = [&] { return run_man(program.man, program.common, text_of(program.app)); };
  });
}

}  // namespace spool::tools
