// The program `spool`: arguments in, verbs called, errors and exit codes out. What a verb takes
// stands in command_line/.
#include <exception>
#include <new>
#include <sstream>
#include <string>

#include "formats/lost_pages.h"
#include "lib/core/heap_policy.h"
#include "lib/core/parallel.h"
#include "tools/command_line/help_text.h"
#include "tools/command_line/image_verbs.h"
#include "tools/command_line/manual.h"
#include "tools/command_line/method_verbs.h"
#include "tools/command_line/misspelt.h"
#include "tools/command_line/recording_verbs.h"
#include "tools/command_line/result_verbs.h"
#include "tools/terminal/interrupt.h"

namespace spool::tools {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 data unusable, 2 wrong use, 3 input or output failed, 4 damage found "
    "or samples gone; after a signal, 128 and its number. Errors are one line on stderr: what is "
    "wrong, where, and what to do.";

// Prints what was asked for; the exit code.
int answer(const std::string& text) {
  print(text);
  const Result<void> arrived = check_output();
  if (arrived) return 0;
  print_error(arrived.error());
  return static_cast<int>(arrived.error().code);
}

int run(int count, char** arguments) {
  Program program;
  program.app.name("spool");
  program.app.footer(kExitCodes);
  program.app.formatter(help_formatter());
  program.app.set_help_flag("-h,--help", "this text");
  program.app.require_subcommand(1);
  program.app.set_version_flag("--version", "spool " SPOOL_VERSION, "the version of the program");
  for (const auto add : {add_info,    add_check,  add_recover,     add_pack,       add_convert,
                         add_synth,   add_replay, add_reconstruct, add_evaluate,   add_metrics,
                         add_compare, add_report, add_figure,      add_picture,    add_show,
                         add_pixel,   add_view,   add_list,        add_completion, add_man})
    add(program);
  group_verbs(program.app);
  if (count == 1) return answer(greeting(program.app));
  try {
    program.app.parse(count, arguments);
  } catch (const CLI::Success& asked_for_help) {
    std::ostringstream text;
    program.app.exit(asked_for_help, text, text);
    return answer(text.str());
  } catch (const CLI::ParseError& error) {
    print_error({ErrorCode::kUsage, explain(program.app, error, count, arguments)});
    return static_cast<int>(ErrorCode::kUsage);
  }
  if (program.common.quiet) keep_quiet();
  watch_for_interrupts();
  Result<void> result = check_bounds("threads", program.common.threads, kThreads);
  const ThreadLimit limit(program.common.threads);
  if (result) result = program.chosen();
  if (result) result = check_output();
  if (result) return 0;
  print_error(result.error());
  return static_cast<int>(result.error().code);
}

}  // namespace
}  // namespace spool::tools

int main(int count, char** arguments) {
  spool::tools::open_standard_streams();
  spool::keep_freed_memory();
  spool::format::survive_lost_pages();
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
