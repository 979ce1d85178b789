#include "tools/command_line/method_verbs.h"

#include <fmt/ranges.h>

#include "lib/core/option_table.h"

namespace spool::tools {
namespace {

// Not 0, which inside of the program stands for an option that was left out.
CLI::Validator some_samples() {
  return CLI::Range(kSamples.lowest, kSamples.highest).description("");
}

}  // namespace

void add_replay(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "replay", "a sampler spends a budget on a recording; counts as EXR");
  ReplayOptions& options = program.replay;
  add_dump(verb, options.dump);
  verb.add_option("--sampler", options.sampler, "see spool list samplers")->required();
  verb.add_option("--filter", options.filter,
                  "in the loop of cross_halves and filtered_halves, in place of their own");
  within(verb.add_option("--spp", options.spp, "budget, samples per pixel on average"), kBudget)
      ->required();
  add_method(verb, options.method);
  add_pool(verb, options.pool);
  verb.add_flag("--decision-split", options.decision_split, kDecisionSplit);
  verb.add_option("--views", options.views,
                  "also write intermediate images, as layers view.NAME: see spool list views");
  verb.add_option("--pictures", options.pictures, "a folder for PNG pictures of the views");
  add_output(verb, options.output, "the selection to write: channel n, and A.0 .. A.K");
  add_common(verb, program.common, true, true);
  verb.footer(
      "A selection contains how many samples of each piece were taken, always the first ones; a "
      "sampler gets only those. Any image of counts made elsewhere is a selection too.\n"
      "Examples:\n"
      "  spool replay dumps/tiny/chess.spool --sampler multiscale --spp 8 -o n.exr\n"
      "  spool replay dumps/tiny/chess.spool --sampler multiscale --preset paper \\\n"
      "    --set sampler.alpha=0.3 --spp 8 -o chess_8.exr\n"
      "  spool reconstruct chess.spool --selection chess_8.exr --filter box -o box.exr");
  runs(verb, program, run_replay, program.replay);
}

void add_reconstruct(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("reconstruct", "the samples of a selection become an image");
  ReconstructOptions& options = program.reconstruct;
  add_dump(verb, options.dump);
  CLI::Option* selection = verb.add_option("--selection", options.selection,
                                           "which samples: an image of counts (channel n, Y, R or "
                                           "its only one), of the recording's size");
  within(verb.add_option("--spp", options.spp, "instead: the first samples of each pixel (all)"),
         kSamples)
      ->check(some_samples())
      ->excludes(selection);
  verb.add_option("--filter", options.filter, "see spool list filters")->required();
  add_method(verb, options.method);
  add_pool(verb, options.pool);
  add_output(verb, options.output,
             "the image to write: R, G, B, scene-linear; NAME.png: a tone-mapped picture of it");
  verb.add_flag(
      "--layers", options.layers,
      "also write variance.R/G/B, filter.level and filter.angle where the filter has them");
  verb.add_option(
      "--views", options.views,
      "also write intermediate images, as layers view.NAME: see spool list views; or all "
      "(with --pieces 2 into NAME_pieces.exr)");
  verb.add_option("--pictures", options.pictures,
                  "a folder for PNG pictures of the result and of the views");
  add_common(verb, program.common, true, true);
  verb.footer(
      "A selection written by spool replay contains the order of its samples; for others, "
      "--order and --seed do.\n"
      "Examples:\n"
      "  spool reconstruct dumps/tiny/chess.spool --filter box --spp 4 -o noisy.exr\n"
      "  spool reconstruct dumps/tiny/chess.spool --selection mine.exr \\\n"
      "    --filter directional --layers --pictures pictures -o filtered.exr");
  runs(verb, program, run_reconstruct, program.reconstruct);
}

void add_pixel(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "pixel", "the samples of a pixel in the order of a replay, and their running mean");
  PixelOptions& options = program.pixel;
  add_dump(verb, options.dump);
  repeatable(
      verb.add_option("--at", options.places, "X,Y from the upper left corner; may be given again")
          ->required());
  within(verb.add_option("--samples", options.samples, "the first so many (all)"), kSamples)
      ->check(some_samples());
  CLI::Option* evaluation =
      verb.add_option("--evaluation-seed", options.evaluation_seed,
                      "the seed of an evaluation: the order in which its replicate 0 takes samples")
          ->transform(seed_check());
  add_order(verb, options.pool.order)->excludes(evaluation);
  verb.add_option("--seed", options.pool.seed, "seed of the order (0)")
      ->transform(seed_check())
      ->excludes(evaluation);
  within(verb.add_option("--holdout", options.pool.holdout,
                         "samples per pixel that are never offered (0)"),
         kHoldout);
  group_options(verb, "Samples",
                {"--samples", "--evaluation-seed", "--order", "--seed", "--holdout"});
  verb.add_option("--sampler", options.sampler, "also: how many samples it takes of the pixel");
  within(
      verb.add_option("--spp", options.spp, "budget of the sampler, samples per pixel on average"),
      kBudget);
  verb.add_option("--filter", options.filter,
                  "also: with which weights it makes the pixel, where the filter returns them");
  add_method(verb, options.method);
  add_common(verb, program.common, true, false);
  verb.footer(
      "A sampler that took n samples of the pixel took the first n of the list. "
      "The weights of a filter are those of pixels' means; they sum to 1 and make the pixel.\n"
      "Examples:\n"
      "  spool pixel dumps/tiny/chess.spool --at 20,30 --sampler multiscale --spp 8 \\\n"
      "    --filter directional\n"
      "  spool pixel dumps/tiny/chess.spool --at 20,30 --samples 16\n"
      "  spool pixel dumps/tiny/chess.spool --at 20,30 --evaluation-seed 1 --json");
  runs(verb, program, run_pixel, program.pixel);
}

void add_view(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "view", "a page that replays any budget and answers for any pixel while one looks");
  verb.add_option("FILE|DIR", program.view.target,
                  "a recording, or the folder that spool evaluate -o DIR wrote")
      ->required();
  within(verb.add_option("--port", program.view.port,
                         "of 127.0.0.1; another one where it is taken; 0 for any free one (0)"),
         kPort);
  verb.add_flag("--allow-commands", program.view.allow_commands,
                "replay the commands (exec:) of the plan in the folder: they are run by this user");
  verb.add_option(
      "--samplers", program.view.samplers,
      "beside those of the recording or the plan: LABEL=exec:COMMAND, NAME{OPTION=VALUE}");
  verb.add_option("--filters", program.view.filters, "the same of filters");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Prints the address and serves the page until Ctrl-C (exit code 130): to this machine only, "
      "at an address with a random token, read-only. --json prints {\"url\": ...} on one line. "
      "Needs what spool report needs.\n"
      "Examples:\n"
      "  spool view dumps/tiny/chess.spool\n"
      "  spool view dumps/tiny/chess.spool --filters 'den=exec:python3 denoise.py'\n"
      "  spool view results --port 8000");
  runs(verb, program, run_view, program.view);
}

void add_list(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("list", "what there is, with every option explained");
  verb.add_option("WHAT", program.list.what,
                  fmt::format("{}, or a method: all its options", fmt::join(lists(), ", ")));
  verb.add_flag(
      "--all", program.list.all,
      "of samplers and filters also the options that few need: readings of a text, details");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Examples:\n"
      "  spool list samplers\n"
      "  spool list twin_guides\n"
      "  spool list filters --json | jq '.[].name'");
  runs(verb, program, run_list, program.list);
}

}  // namespace spool::tools
