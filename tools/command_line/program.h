// What a command line becomes: every verb is a function with a plain struct of options, filled by
// CLI11, which is included here and nowhere outside of this folder.
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/manual/completion.h"
#include "tools/manual/man_page.h"
#include "tools/show/show.h"
#include "tools/terminal/console.h"
#include "tools/verbs/check.h"
#include "tools/verbs/compare.h"
#include "tools/verbs/convert.h"
#include "tools/verbs/evaluate.h"
#include "tools/verbs/figure.h"
#include "tools/verbs/info.h"
#include "tools/verbs/list.h"
#include "tools/verbs/metrics.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/pack.h"
#include "tools/verbs/picture.h"
#include "tools/verbs/pixel.h"
#include "tools/verbs/reconstruct.h"
#include "tools/verbs/replay.h"
#include "tools/verbs/report.h"
#include "tools/verbs/synth.h"
#include "tools/view/view.h"

namespace spool::tools {

using Verb = std::function<Result<void>()>;

struct Program {
  CLI::App app{
      "Spool: a laboratory for adaptive sampling and reconstruction in Monte Carlo "
      "rendering.\nRecords every sample of an image once, replays samplers on the recording, "
      "filters, and measures."};
  CommonOptions common;
  InfoOptions info;
  CheckOptions check;
  RecoverOptions recover;
  PackVerbOptions pack;
  ConvertOptions convert;
  SynthOptions synth;
  ReplayOptions replay;
  ReconstructOptions reconstruct;
  EvaluateOptions evaluate;
  MetricsOptions metrics;
  CompareOptions compare;
  ReportOptions report;
  FigureOptions figure;
  PictureOptions picture;
  ShowOptions show;
  PixelOptions pixel;
  ViewOptions view;
  ListOptions list;
  CompletionOptions completion;
  ManOptions man;
  Verb chosen;
};

// "--spp" where an option or an argument was given as ""; else nothing.
std::string empty_option(const CLI::App& verb);

// What a verb does when it is chosen.
template <class Options>
void runs(CLI::App& verb, Program& program,
          Result<void> (*run)(const Options&, const CommonOptions&), const Options& options) {
  verb.callback([&verb, &program, &options, run] {
    if (const std::string name = empty_option(verb); !name.empty())
      throw CLI::ValidationError(name, "");  // misspelt.h words it
    program.chosen = [&program, &options, run] { return run(options, program.common); };
  });
}

// The switches of a verb; every verb takes --threads and --quiet.
void add_common(CLI::App& verb, CommonOptions& common, bool json, bool force);
// Puts options below a heading of the help.
void group_options(CLI::App& verb, const char* group, std::initializer_list<const char*> options);
// Reads the number in decimal, and says in the help what it may be, which validate() of the verb
// looks at.
CLI::Option* within(CLI::Option* option, const Bounds& bounds);
// May be given several times, with one value each.
CLI::Option* repeatable(CLI::Option* option);
// Every value there is, where CLI11 or the option's text lists them.
std::vector<std::string> written_choices(const CLI::Option& option);
// A seed as plans have it, too, in decimal: TOML has no larger numbers.
CLI::Validator seed_check();
void add_dump(CLI::App& verb, std::filesystem::path& dump);
// --layer and --part, with `before` in front of both words.
void add_layer(CLI::App& verb, LayerChoice& choice, const std::string& before,
               const std::string& whose);
void add_output(CLI::App& verb, std::filesystem::path& output, const std::string& help);
void add_method(CLI::App& verb, MethodOptions& method);
CLI::Option* add_order(CLI::App& verb, PoolOrder& order);
void add_pool(CLI::App& verb, PoolOptions& pool);

inline constexpr const char* kPieces =
    "pieces per side of a pixel: 1, or 2 where film positions were recorded (1)";
inline constexpr const char* kDecisionSplit =
    "the even samples of a pixel decide how many odd ones are averaged, and the odd ones about the "
    "even: unbiased, noisier, takes more than the budget";

}  // namespace spool::tools
