// The program `spool`: arguments in, verbs called, errors and exit codes out.
//
// The only file that includes CLI11, which costs seconds per translation unit; every verb is a
// function with a plain struct of options.
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lib/core/option_table.h"
#include "lib/core/parallel.h"
#include "tools/check.h"
#include "tools/console.h"
#include "tools/info.h"
#include "tools/interrupt.h"

namespace spool::tools {
namespace {

using Verb = std::function<Result<void>()>;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 data unusable, 2 wrong use, 3 input or output failed, 4 damage found.\n"
    "Errors are one line on stderr: what is wrong, where, and what to do.";

struct Program {
  CLI::App app{
      "Spool: a laboratory for adaptive sampling and reconstruction in Monte Carlo "
      "rendering.\nRecords every sample of an image once, replays samplers on the record, "
      "filters, and measures."};
  CommonOptions common;
  InfoOptions info;
  CheckOptions check;
  Verb chosen;
};

// The switches of a verb; every verb takes --threads and --quiet.
void add_common(CLI::App& verb, CommonOptions& common, bool json, bool force) {
  if (json) verb.add_flag("--json", common.json, "print JSON instead of text");
  if (force) verb.add_flag("--force", common.force, "replace what exists");
  verb.add_flag("--quiet,-q", common.quiet, "no progress, no remarks");
  verb.add_option("--threads", common.threads,
                  "threads to use, 0 for all; the results do not depend on it")
      ->check(CLI::Range(0, 1024));
}

void add_dump(CLI::App& verb, std::filesystem::path& dump) {
  verb.add_option("FILE", dump, "a recorded dump, NAME.spool")->required();
}

void add_info(Program& program) {
  CLI::App& verb = *program.app.add_subcommand("info", "what was recorded");
  add_dump(verb, program.info.dump);
  add_common(verb, program.common, true, false);
  verb.footer(
      "Examples:\n"
      "  spool info dumps/tiny/chess.spool\n"
      "  spool info dumps/tiny/chess.spool --json | jq .samples_per_pixel");
  verb.callback([&] { program.chosen = [&] { return run_info(program.info, program.common); }; });
}

void add_check(Program& program) {
  CLI::App& verb = *program.app.add_subcommand("check", "verify every record of a dump");
  add_dump(verb, program.check.dump);
  add_common(verb, program.common, true, false);
  verb.footer(
      "Exit code 4 and a list of what is lost when the file is damaged or incomplete.\n"
      "Examples:\n"
      "  spool check dumps/tiny/chess.spool\n"
      "  for f in *.spool; do spool check -q $f || echo \"$f is damaged\"; done");
  verb.callback([&] { program.chosen = [&] { return run_check(program.check, program.common); }; });
}

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

// CLI11's complaints in one line, with the nearest known name where a word is unknown.
std::string explain(const CLI::App& app, const CLI::ParseError& error, int count,
                    char** arguments) {
  const CLI::App* verb = nullptr;
  for (const CLI::App* parsed : app.get_subcommands())
    verb = parsed;
  if (!verb && count > 1 && arguments[1][0] != '-') {
    const std::string word = arguments[1];
    const std::string near = nearest_name(word, known_words(app, false));
    return fmt::format("unknown verb '{}'{}: see spool --help", word,
                       near.empty() ? "" : fmt::format(", did you mean '{}'?", near));
  }
  const CLI::App& at = verb ? *verb : app;
  const std::string help = verb ? "spool " + verb->get_name() + " --help" : "spool --help";
  for (const std::string& word : app.remaining(true)) {
    if (word.rfind("--", 0) != 0) continue;
    const std::string near = nearest_name(word.substr(0, word.find('=')), known_words(at, true));
    return fmt::format("unknown option '{}'{}: see {}", word,
                       near.empty() ? "" : fmt::format(", did you mean '{}'?", near), help);
  }
  return fmt::format("{}: see {}", error.what(), help);
}

int run(int count, char** arguments) {
  Program program;
  program.app.name("spool");
  program.app.footer(std::string(kExitCodes) + "\n\nEach verb explains itself: spool VERB --help");
  program.app.require_subcommand(1);
  program.app.set_version_flag("--version", "spool " SPOOL_VERSION);
  add_info(program);
  add_check(program);
  try {
    program.app.parse(count, arguments);
  } catch (const CLI::Success& asked_for_help) {
    return program.app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    print_error({ErrorCode::kUsage, explain(program.app, error, count, arguments)});
    return static_cast<int>(ErrorCode::kUsage);
  }
  watch_for_interrupts();
  const ThreadLimit limit(program.common.threads);
  const Result<void> result = program.chosen();
  if (result) return 0;
  print_error(result.error());
  return static_cast<int>(result.error().code);
}

}  // namespace
}  // namespace spool::tools

int main(int count, char** arguments) {
  try {
    return spool::tools::run(count, arguments);
  } catch (const std::bad_alloc&) {
    spool::tools::print_error({spool::ErrorCode::kIo, "out of memory: use a smaller image"});
    return static_cast<int>(spool::ErrorCode::kIo);
  } catch (const std::exception& error) {
    spool::tools::print_error({spool::ErrorCode::kData, error.what()});
    return static_cast<int>(spool::ErrorCode::kData);
  }
}
