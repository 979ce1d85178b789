#include "tools/manual/completion.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "lib/core/nearest_name.h"
#include "lib/core/visible_text.h"

namespace spool::tools {
namespace {

std::vector<std::string> names_of_verbs(const ProgramText& program) {
  std::vector<std::string> names;
  for (const VerbText& verb : program.verbs)
    names.push_back(verb.name);
  return names;
}

std::vector<std::string> option_names(const VerbText& verb) {
  std::vector<std::string> names;
  for (const OptionText& option : verb.options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

// The first argument by its place that has choices.
std::vector<std::string> choices_by_place(const VerbText& verb) {
  const auto found = std::ranges::find_if(
      verb.arguments, [](const OptionText& argument) { return !argument.choices.empty(); });
  return found == verb.arguments.end() ? std::vector<std::string>{} : found->choices;
}

// Words offered after "VERB OPTION"; what has no words is left to the shell, which offers files.
std::string bash_cases(const VerbText& verb) {
  std::string text;
  std::vector<std::string> with_value;
  for (const OptionText& option : verb.options) {
    if (option.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names)
      patterns.push_back(fmt::format("\"{} {}\"", verb.name, name));
    if (option.choices.empty()) {
      with_value.insert(with_value.end(), patterns.begin(), patterns.end());
    } else {
      text += fmt::format("    {}) words={} ;;\n", fmt::join(patterns, " | "),
                          shell_quoted(fmt::format("{}", fmt::join(option.choices, " "))));
    }
  }
  if (!with_value.empty()) text += fmt::format("    {}) ;;\n", fmt::join(with_value, " | "));
  return text +
         fmt::format("    \"{} \"*) options={} places={} ;;\n", verb.name,
                     shell_quoted(fmt::format("{}", fmt::join(option_names(verb), " "))),
                     shell_quoted(fmt::format("{}", fmt::join(choices_by_place(verb), " "))));
}

std::string bash_script(const ProgramText& program) {
  std::string cases;
  for (const VerbText& verb : program.verbs)
    cases += bash_cases(verb);
  return fmt::format(
      R"(# bash completion of {0}, made by: {0} completion bash
_{0}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" words="" options="" places="" listed=""
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    words={1}
  else
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD - 1]}}" in
{2}    esac
    if [[ "$word" == -* ]]; then words="$options"; else words="$words $places"; fi
  fi
  # Of a list, a,b,c, the last part.
  if [[ "$word" == *,* ]]; then listed="${{word%,*}},"; fi
  mapfile -t COMPREPLY < <(compgen -P "$listed" -W "$words" -- "${{word##*,}}")
}}
complete -o default -o bashdefault -F _{0} {0}
)",
      program.name,
      shell_quoted(fmt::format("{} --help --version", fmt::join(names_of_verbs(program), " "))),
      cases);
}

// Of an _arguments specification: brackets and colons part its fields.
std::string zsh_field(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_values(const OptionText& option) {
  return option.choices.empty()
             ? "_files"
             : fmt::format("_values -s , value {}", fmt::join(option.choices, " "));
}

std::string zsh_verb(const VerbText& verb) {
  std::vector<std::string> specifications;
  for (const OptionText& option : verb.options) {
    for (const std::string& name : option.names) {
      std::string text =
          fmt::format("{}{}[{}]", option.several ? "*" : "", name, zsh_field(option.help));
      if (!option.value.empty())
        text += fmt::format(":{}:{}", zsh_field(option.value), zsh_values(option));
      specifications.push_back(shell_quoted(text));
    }
  }
  for (const OptionText& argument : verb.arguments) {
    specifications.push_back(shell_quoted(fmt::format(
        "{}:{}:{}", argument.several ? "*" : "", argument.names.front(), zsh_values(argument))));
  }
  return fmt::format("    {}) _arguments {} ;;\n", verb.name,
                     fmt::join(specifications, " \\\n      "));
}

std::string zsh_script(const ProgramText& program) {
  std::string verbs, cases;
  for (const VerbText& verb : program.verbs) {
    verbs += "    " + shell_quoted(verb.name + ":" + zsh_field(verb.summary)) + "\n";
    cases += zsh_verb(verb);
  }
  return fmt::format(R"(#compdef {0}
# zsh completion of {0}, made by: {0} completion zsh
_{0}() {{
  local -a verbs
  verbs=(
{1}  )
  if ((CURRENT == 2)); then
    _describe verb verbs
    return
  fi
  shift words
  ((CURRENT--))
  case "${{words[1]}}" in
{2}  esac
}}
_{0} "$@"
)",
                     program.name, verbs, cases);
}

std::string fish_option(const ProgramText& program, const VerbText& verb,
                        const OptionText& option) {
  std::string text = fmt::format("complete -c {} -n {}", program.name,
                                 shell_quoted("__fish_seen_subcommand_from " + verb.name));
  for (const std::string& name : option.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.value.empty()) text += option.choices.empty() ? " -r" : " -x";
  if (!option.choices.empty())
    text += " -a " + shell_quoted(fmt::format("{}", fmt::join(option.choices, " ")));
  return text + " -d " + shell_quoted(option.help) + "\n";
}

std::string fish_script(const ProgramText& program) {
  std::string text =
      fmt::format("# fish completion of {0}, made by: {0} completion fish\n", program.name);
  for (const VerbText& verb : program.verbs) {
    text += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", program.name,
                        verb.name, shell_quoted(verb.summary));
    for (const OptionText& option : verb.options)
      text += fish_option(program, verb, option);
    const std::vector<std::string> places = choices_by_place(verb);
    if (!places.empty()) {
      text += fmt::format("complete -c {} -n {} -a {}\n", program.name,
                          shell_quoted("__fish_seen_subcommand_from " + verb.name),
                          shell_quoted(fmt::format("{}", fmt::join(places, " "))));
    }
  }
  return text;
}

}  // namespace

const std::vector<std::string>& completion_shells() {
  static const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  return shells;
}

Result<std::string> completion_script(const ProgramText& program, std::string_view shell) {
  if (shell == "bash") return bash_script(program);
  if (shell == "zsh") return zsh_script(program);
  if (shell == "fish") return fish_script(program);
  return fail(ErrorCode::kUsage, "{}", unknown_name("shell", shell, completion_shells()));
}

Result<void> run_completion(const CompletionOptions& options, const ProgramText& program) {
  SPOOL_ASSIGN(const std::string script, completion_script(program, options.shell));
  print(script);
  return {};
}

}  // namespace spool::tools
