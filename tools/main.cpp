// The program `spool`: arguments in, verbs called, errors and exit codes out.
//
// The only file that includes CLI11, which costs seconds per translation unit; every verb is a
// function with a plain struct of options.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "formats/lost_pages.h"
#include "lib/core/heap_policy.h"
#include "lib/core/option_table.h"
#include "lib/core/parallel.h"
#include "lib/exchange/foreign_formats.h"
#include "lib/experiment/reference.h"
#include "lib/experiment/result_record.h"
#include "tools/check.h"
#include "tools/compare.h"
#include "tools/console.h"
#include "tools/convert.h"
#include "tools/evaluate.h"
#include "tools/figure_verb.h"
#include "tools/foreign_settings.h"
#include "tools/info.h"
#include "tools/interrupt.h"
#include "tools/list.h"
#include "tools/metrics_verb.h"
#include "tools/pack.h"
#include "tools/picture_verb.h"
#include "tools/pixel_verb.h"
#include "tools/reconstruct.h"
#include "tools/recover.h"
#include "tools/replay.h"
#include "tools/report_verb.h"
#include "tools/synth.h"

namespace spool::tools {
namespace {

using Verb = std::function<Result<void>()>;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 data unusable, 2 wrong use, 3 input or output failed, 4 damage found "
    "or\n"
    "samples gone; after a signal, 128 and its number.\n"
    "Errors are one line on stderr: what is wrong, where, and what to do.";

struct Program {
  CLI::App app{
      "Spool: a laboratory for adaptive sampling and reconstruction in Monte Carlo "
      "rendering.\nRecords every sample of an image once, replays samplers on the record, "
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
  PixelOptions pixel;
  ListOptions list;
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

// A seed as plans have it, too: TOML has no larger numbers. CLI11 itself wraps what is negative.
CLI::Validator seed_check() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        std::int64_t seed = -1;
        const char* end = text.data() + text.size();
        const auto parsed = std::from_chars(text.data(), end, seed);
        if (parsed.ec == std::errc() && parsed.ptr == end && seed >= 0) return "";
        return fmt::format("a seed is a whole number from 0 to {}, not {}",
                           std::numeric_limits<std::int64_t>::max(), text);
      },
      "");
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

void add_output(CLI::App& verb, std::filesystem::path& output, const std::string& help) {
  verb.add_option("-o,--output", output, help)->required();
}

void add_recover(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("recover", "all intact records of a damaged dump, as a new one");
  verb.add_option("IN", program.recover.input, "a cut or damaged dump")->required();
  verb.add_option("OUT", program.recover.output, "the dump to write")->required();
  add_common(verb, program.common, true, true);
  verb.footer(
      "Exit code 4 and a list of what is lost when anything is; the new file is whole in itself.\n"
      "Examples:\n"
      "  spool recover damaged.spool saved.spool\n"
      "  spool recover night.spool.partial saved.spool    (a recording that was interrupted)");
  verb.callback(
      [&] { program.chosen = [&] { return run_recover(program.recover, program.common); }; });
}

void add_pack(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "pack", "folders of recorded passes, or a foreign file, become one dump");
  format::PackOptions& pack = program.pack.pack;
  verb.add_option("SOURCES", program.pack.sources,
                  "folders that a recorder wrote, joined in this order; or a foreign file")
      ->required();
  std::vector<std::string> kinds = names_of(exchange::import_formats());
  kinds.insert(kinds.begin(), "passes");
  verb.add_option("--from", program.pack.from,
                  fmt::format("what SOURCES are: {} (default passes)", fmt::join(kinds, ", ")))
      ->check(CLI::IsMember(kinds).description(""))
      ->option_text("FORMAT");
  add_output(verb, program.pack.output, "the dump to write, NAME.spool");
  verb.add_flag("--compress", pack.compress, "zstd, where it saves 5 % or more");
  verb.add_flag("--half-radiance", pack.radiance_f16, "radiance as 16-bit floats (32)");
  verb.add_flag("--full-features", pack.features_f32, "features as 32-bit floats (16)");
  verb.add_option("--set", program.pack.settings,
                  "import.OPTION=VALUE, an option of the foreign format: see spool list imports")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option("--max-expansion", program.pack.max_expansion,
                  "of foreign files: how many times larger than its source the dump may be (100)")
      ->check(CLI::Range(uint64_t{1}, interchange::kMaxExpansionTimes));
  add_common(verb, program.common, true, true);
  verb.footer(
      "docs/formats.md says what each foreign format holds and what is converted or dropped.\n"
      "Examples:\n"
      "  spool pack chess.passes -o chess.spool\n"
      "  spool pack machine1.passes machine2.passes --compress -o chess.spool\n"
      "  spool pack --from npz samples.npz --set import.layout=HWSC -o mine.spool\n"
      "  spool pack --from exr-folder renders --set import.map=albedo=DiffCol \\\n"
      "    -o mine.spool");
  verb.callback([&] { program.chosen = [&] { return run_pack(program.pack, program.common); }; });
}

void add_convert(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("convert", "a dump becomes a neighbour's file or folder");
  ConvertOptions& options = program.convert;
  verb.add_option("IN", options.input, "a recorded dump, NAME.spool")->required();
  const std::vector<std::string> kinds = names_of(exchange::export_formats());
  verb.add_option("--to", options.to, fmt::format("{}", fmt::join(kinds, ", ")))
      ->required()
      ->check(CLI::IsMember(kinds).description(""))
      ->option_text("FORMAT REQUIRED");
  verb.add_option("--set", options.settings,
                  "export.OPTION=VALUE, an option of the format: see spool list exports")
      ->take_all()
      ->allow_extra_args(false);
  add_output(verb, options.output,
             "npz, bcd, deep-exr: the file; bcd-stats: P.exr, P_cov.exr, P_hist.exr; exr-folder, "
             "oidn: the folder");
  add_common(verb, program.common, true, true);
  verb.footer(
      "What a format has no place for is refused or named. docs/formats.md tells more.\n"
      "Examples:\n"
      "  spool convert dumps/tiny/chess.spool --to npz -o chess.npz\n"
      "  spool convert dumps/tiny/chess.spool --to oidn --set export.spp=1,2,4,8 -o oidn_set\n"
      "  spool convert dumps/tiny/chess.spool --to bcd-stats --set export.spp=16 -o chess_bcd");
  verb.callback(
      [&] { program.chosen = [&] { return run_convert(program.convert, program.common); }; });
}

void add_synth(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "synth", "an analytic scene with its exact reference, as a dump; needs no renderer");
  SynthOptions& options = program.synth;
  verb.add_option("NAME", options.scene, "see spool list scenes")->required();
  verb.add_option("--size", options.size, "WxH or N pixels (128x128)");
  verb.add_option("--samples", options.spp, "per pixel (64)")->check(CLI::Range(1, 65536));
  verb.add_option("--seed", options.seed, "of the samples (1)")->check(seed_check());
  verb.add_option("--set", options.settings, "OPTION=VALUE of the scene: see spool list scenes")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_flag("--compress", options.compress, "zstd, where it saves 5 % or more");
  add_output(verb, options.output, "the dump to write, NAME.spool");
  add_common(verb, program.common, false, true);
  verb.footer(
      "Examples:\n"
      "  spool synth scene_s --size 128 --samples 64 -o s.spool\n"
      "  spool synth slanted_edge --set angle=45 -o edge.spool");
  verb.callback([&] { program.chosen = [&] { return run_synth(program.synth, program.common); }; });
}

void add_method(CLI::App& verb, MethodOptions& method) {
  verb.add_option("--preset", method.preset,
                  "values of all options at once: see spool list presets");
  verb.add_option("--set", method.settings,
                  "an option of a method, PART.OPTION=VALUE; PART is sampler, filter, pool or the "
                  "name of one method; may be given several times")
      ->take_all()
      ->allow_extra_args(false);
}

constexpr const char* kPieces =
    "pieces per side of a pixel: 1, or 2 where film positions were recorded (1)";
constexpr const char* kDecisionSplit =
    "the even samples of a pixel decide how many odd ones are averaged, and the odd ones about the "
    "even: unbiased, noisier, takes more than the budget";

void add_pool(CLI::App& verb, PoolOptions& pool) {
  verb.add_option("--order", pool.order,
                  "order of each pixel's samples: recorded (default) or shuffled by --seed")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, PoolOrder>{{"recorded", PoolOrder::kRecorded},
                                                       {"shuffled", PoolOrder::kShuffled}})
                      .description(""))
      ->option_text("recorded|shuffled");
  verb.add_option("--seed", pool.seed, "seed of the order and of the method (0)")
      ->check(seed_check());
  verb.add_option("--holdout", pool.holdout, "samples per pixel that are never offered (0)")
      ->check(CLI::Range(0, 65535));
  verb.add_option("--pieces", pool.pieces_per_side, kPieces)->check(CLI::Range(1, 2));
}

void add_replay(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("replay", "a sampler spends a budget on a dump; counts as EXR");
  ReplayOptions& options = program.replay;
  add_dump(verb, options.dump);
  verb.add_option("--sampler", options.sampler, "see spool list samplers")->required();
  verb.add_option("--filter", options.filter,
                  "in the loop of cross_halves and filtered_halves, in place of their own");
  verb.add_option("--spp", options.spp, "budget, samples per pixel on average")
      ->required()
      ->check(CLI::Range(1e-3, 65536.0));
  add_method(verb, options.method);
  add_pool(verb, options.pool);
  verb.add_flag("--decision-split", options.decision_split, kDecisionSplit);
  verb.add_option("--views", options.views,
                  "also write intermediate images, as layers view.NAME: see spool list views");
  verb.add_option("--pictures", options.pictures, "a folder for PNG pictures of the views");
  add_output(verb, options.output, "the selection to write: channel n, and A.0 .. A.K");
  add_common(verb, program.common, true, true);
  verb.footer(
      "A selection says how many samples of each piece were taken, always the first ones; a\n"
      "sampler may know only those. Any image of counts made elsewhere is a selection too.\n"
      "Examples:\n"
      "  spool replay dumps/tiny/chess.spool --sampler multiscale --spp 8 -o chess_8.exr\n"
      "  spool replay dumps/tiny/chess.spool --sampler multiscale --preset paper \\\n"
      "    --set sampler.alpha=0.3 --spp 8 -o chess_8.exr\n"
      "  spool reconstruct dumps/tiny/chess.spool --selection chess_8.exr --filter box -o box.exr");
  verb.callback(
      [&] { program.chosen = [&] { return run_replay(program.replay, program.common); }; });
}

void add_reconstruct(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("reconstruct", "the samples of a selection become an image");
  ReconstructOptions& options = program.reconstruct;
  add_dump(verb, options.dump);
  CLI::Option* selection = verb.add_option(
      "--selection", options.selection,
      "which samples: an image of counts (channel n, Y, R or its only one), of the dump's size");
  verb.add_option("--spp", options.spp, "instead: the first samples of each pixel (all)")
      ->check(CLI::Range(1, 65536))
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
      "A selection written by spool replay says in which order it took the samples; for others,\n"
      "--order and --seed do.\n"
      "Examples:\n"
      "  spool reconstruct dumps/tiny/chess.spool --filter box --spp 4 -o noisy.exr\n"
      "  spool reconstruct dumps/tiny/chess.spool --selection mine.exr --filter directional \\\n"
      "    --layers --pictures pictures -o filtered.exr");
  verb.callback([&] {
    program.chosen = [&] { return run_reconstruct(program.reconstruct, program.common); };
  });
}

std::string reference_names() {
  std::string names;
  for (const ReferenceDescription& kind : reference_kinds())
    names += (names.empty() ? "" : ", ") + kind.name + (kind.biased ? " (biased)" : "");
  return names;
}

// An evaluation that is looked at beforehand, spread over machines, or put together.
void add_parts_of_a_run(CLI::App& verb, EvaluateOptions& options) {
  verb.add_flag("--dry-run", options.dry_run,
                "list the cells and about how long they will take; runs no command of the plan");
  verb.add_option(
          "--timing", options.timing,
          "shared: results of small pictures are made beside each other, on all processors, "
          "and the column `timing` says so; exact: one after another (shared)")
      ->check(CLI::IsMember({"shared", "exact"}));
  verb.add_option("--shard", options.shard,
                  "i/N: only that part of the cells, for machine i of N (0/4 .. 3/4)");
  verb.add_flag("--merge", options.merge,
                "run nothing: make the results of the cells that are done");
  verb.add_flag("--statistics-only", options.statistics_only,
                "run nothing: compute statistics.json of these folders of results anew");
  verb.add_option("--from", options.merge_from,
                  "with --merge: folders whose cells are taken over first; may be given several "
                  "times")
      ->take_all()
      ->allow_extra_args(false);
}

void add_evaluate(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "evaluate", "every sampler with every filter at every budget: error, time, pictures");
  EvaluateOptions& options = program.evaluate;
  verb.add_option("FILES", options.files,
                  "recorded dumps; one PLAN.toml that says everything; or, with --statistics-only, "
                  "folders of results")
      ->required();
  verb.add_option("--samplers", options.samplers, "a,b:PRESET,LABEL=c{OPTION=VALUE} (uniform)");
  verb.add_option("--filters", options.filters, "the same of filters (box)");
  verb.add_option("--spp", options.spp, "budgets in samples per pixel: 4,8,16");
  verb.add_option("--replicates", options.replicates,
                  "repetitions, with samples that no other has as far as they reach (8)")
      ->check(CLI::Range(1, 100000));
  verb.add_option("--repeats", options.repeats,
                  "times each stage is run for the median of its time (1)")
      ->check(CLI::Range(1, 1000));
  verb.add_option("--sweep-threads", options.cell_threads,
                  "run everything with each of these numbers of threads: 1,2,4");
  add_method(verb, options.methods);
  verb.add_option("--reference", options.reference,
                  "what images are judged by: " + reference_names() +
                      " (default: the first of these that the dump can give)");
  verb.add_option("--holdout", options.holdout,
                  "samples per pixel kept for judging (a quarter, where they are needed)")
      ->check(CLI::Range(0, 65535));
  verb.add_option("--seed", options.seed, "seed of all replicates (1)")->check(seed_check());
  verb.add_flag("--recorded-order", options.recorded_order,
                "take samples in recorded order; all replicates are then alike");
  verb.add_option("--pieces", options.pieces_per_side, kPieces)->check(CLI::Range(1, 2));
  verb.add_flag("--decision-split", options.decision_split, kDecisionSplit);
  verb.add_flag("--fresh", options.fresh,
                "also apply the counts to samples that had no say in them, and take bias and "
                "variance apart: columns *_fresh, *_bias2, *_variance; three times the work");
  verb.add_flag("--no-pictures", options.no_pictures, "numbers only");
  add_parts_of_a_run(verb, options);
  verb.add_option("-o,--output", options.output, "folder for the results and the pictures");
  add_common(verb, program.common, true, true);
  verb.footer(
      "results.csv and results.jsonl have one row per recording, sampler, filter, budget and\n"
      "replicate: spool list columns. A run that was interrupted goes on when started again;\n"
      "--force starts it anew. MSE is debiased by the variance of the reference and may be "
      "slightly\n"
      "negative. `pool` judges an image by the samples it was made of: biased, and differently "
      "for\n"
      "each method.\n"
      "Examples:\n"
      "  spool evaluate dumps/tiny/chess.spool --samplers uniform,multiscale \\\n"
      "    --filters box,directional --spp 4,8,16 -o results\n"
      "  spool evaluate tools/plans/quick.toml -o results\n"
      "  spool evaluate plan.toml --dry-run\n"
      "  spool evaluate --statistics-only results\n"
      "  spool evaluate plan.toml --shard 3/16 -o shared/results       (on machine 3 of 16)\n"
      "  spool evaluate plan.toml --merge -o shared/results            (when all are done)");
  verb.callback(
      [&] { program.chosen = [&] { return run_evaluate(program.evaluate, program.common); }; });
}

void add_metrics(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("metrics", "every metric of one image against another");
  MetricsOptions& options = program.metrics;
  verb.add_option("IMAGE", options.image, "an EXR: R, G, B or one channel, scene-linear")
      ->required();
  verb.add_option("REFERENCE", options.reference, "an EXR of the same size")->required();
  verb.add_option("--variance", options.variance,
                  "EXR with the variance of the reference's mean: errors are debiased by it");
  verb.add_option("--mask", options.masks,
                  "NAME=FILE.exr: energy ratio where the mask is above 0.5; several times")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option("--set", options.settings,
                  "OPTION=VALUE of the metrics (spool list metrics): rel_scale=none")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option("--error-map", options.error_map, "also write the squared error of each pixel");
  add_common(verb, program.common, true, true);
  verb.footer(
      "Examples:\n"
      "  spool metrics mine.exr reference.exr\n"
      "  spool metrics mine.exr reference.exr --json --set rel_scale=none --set rel_eps=0.001");
  verb.callback(
      [&] { program.chosen = [&] { return run_metrics(program.metrics, program.common); }; });
}

void add_compare(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "compare", "what became better or worse between two evaluations, beyond the noise");
  CompareOptions& options = program.compare;
  verb.add_option("BEFORE", options.before, "a folder of spool evaluate")->required();
  verb.add_option("AFTER", options.after, "another one")->required();
  verb.add_option("--metric", options.metrics,
                  "one or several: " + fmt::format("{}", fmt::join(compared_metrics(), ", ")) +
                      ", cpu (relmse)");
  verb.add_option("--significance", options.significance,
                  "chance of a claim where nothing changed, of all comparisons together (0.05)")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_option("--match", options.match_name,
                  "label: methods with the same options; name: whatever their options (label)")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, bool>{{"label", false}, {"name", true}}));
  verb.add_option("--tolerance", options.tolerance,
                  "relative changes up to this are let pass: 0.01 (0)")
      ->check(CLI::Range(0.0, 1e6));
  verb.add_flag("--all", options.all, "also list what did not change");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Exit code 1 when something became worse, failed, or is missing in AFTER: for a build\n"
      "machine. Differences are paired where both drew the same samples.\n"
      "Examples:\n"
      "  spool evaluate plan.toml -o new && spool compare accepted new\n"
      "  spool compare accepted new --metric relmse,cpu --tolerance 0.02\n"
      "  spool compare alpha_03 alpha_04 --match name");
  verb.callback(
      [&] { program.chosen = [&] { return run_compare(program.compare, program.common); }; });
}

void add_report(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "report", "one HTML file of an evaluation: results at a glance, charts, table, images");
  ReportOptions& options = program.report;
  verb.add_option("DIR", options.folder, "the folder that spool evaluate -o DIR wrote")->required();
  add_output(verb, options.output, "the HTML file; it needs no network and no other file");
  verb.add_option("--metric", options.metric, "the error that the summary compares (relmse)");
  verb.add_option("--max-image-mb", options.max_image_mb,
                  "megabytes of images in the page; beyond, crops and links to the EXRs (40)")
      ->check(CLI::Range(0.0, 1e6));
  verb.add_option("--title", options.title, "heading of the page (names of the recordings)");
  add_common(verb, program.common, false, true);
  verb.footer(
      "Needs Python 3 with numpy (SPOOL_PYTHON names the interpreter) and, once, the scripts that\n"
      "tools/report/fetch_assets.sh fetches.\n"
      "Examples:\n"
      "  spool evaluate dumps/tiny/chess.spool --spp 4,8,16 -o results\n"
      "  spool report results -o report.html");
  verb.callback(
      [&] { program.chosen = [&] { return run_report(program.report, program.common); }; });
}

void add_figure(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "figure", "figures and tables of an evaluation for a paper: PDF, SVG, PNG, LaTeX");
  FigureOptions& options = program.figure;
  verb.add_option("SOURCE", options.source,
                  "the folder that spool evaluate -o DIR wrote, or PLAN.toml, which is evaluated "
                  "into FOLDER/results first")
      ->required();
  add_output(verb, options.output, "the folder of the figures");
  verb.add_option("--metric", options.metric, "the error (relmse)");
  verb.add_option("--spp", options.spp, "budget of the comparisons (the middle one)")
      ->check(CLI::Range(0.0, 65536.0));
  verb.add_option("--recording", options.recordings, "compare on this one; may be given again");
  verb.add_option(
          "--method", options.methods,
          "'SAMPLER + FILTER' to show, in this order; may be given again (uniform + box and "
          "the best)")
      ->take_all()
      ->allow_extra_args(false);
  add_common(verb, program.common, false, true);
  verb.footer(
      "Writes comparison_RECORDING (reference, insets where methods differ most, error maps, "
      "numbers)\nand curves, each as .pdf, .svg and .png; curves.csv and curves.py, which draws "
      "it; "
      "table.tex\nand table.md. Bold: told apart from every other method. Needs Python 3 with "
      "numpy and matplotlib.\n"
      "Examples:\n"
      "  spool figure results -o figures\n"
      "  spool figure results -o figures --spp 4 --method 'uniform + box' \\\n"
      "    --method 'multiscale + directional'\n"
      "  spool figure tools/plans/quick.toml -o figures");
  verb.callback(
      [&] { program.chosen = [&] { return run_figure(program.figure, program.common); }; });
}

void add_picture(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "picture", "an EXR as a PNG to look at: tone-mapped, or false colour with its bar");
  PictureOptions& options = program.picture;
  verb.add_option("IMAGE", options.image, "an OpenEXR image")->required();
  CLI::Option* exposure =
      verb.add_option("--exposure", options.exposure,
                      "EV: values times 2^EV, then sRGB (the log-average luminance becomes middle "
                      "grey)")
          ->check(CLI::Range(-100.0, 100.0));
  verb.add_option("--like", options.like, "take the automatic exposure from this image")
      ->excludes(exposure);
  CLI::Option* colour = verb.add_flag("--false-colour", options.false_colour,
                                      "one channel, or the luminance, as colours with a bar");
  colour->excludes(exposure);
  verb.add_option("--channel", options.channel, "of --false-colour: its name")->needs(colour);
  verb.add_option("--range", options.range, "of --false-colour: LOW,HIGH (all values)")
      ->needs(colour);
  verb.add_flag("--log", options.log, "of --false-colour: a logarithmic scale")->needs(colour);
  add_output(verb, options.output, "the picture to write, NAME.png");
  add_common(verb, program.common, false, true);
  verb.footer(
      "For eyes, not for measuring. Pixels that are not finite are magenta.\n"
      "Examples:\n"
      "  spool picture image.exr -o image.png\n"
      "  spool picture image.exr --like reference.exr -o image.png\n"
      "  spool picture density.exr --false-colour --log --range 1,64 -o density.png");
  verb.callback(
      [&] { program.chosen = [&] { return run_picture(program.picture, program.common); }; });
}

void add_pixel(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "pixel", "the samples of a pixel in the order of a replay, and their running mean");
  PixelOptions& options = program.pixel;
  add_dump(verb, options.dump);
  verb.add_option("--at", options.places, "X,Y from the upper left corner; may be given again")
      ->required()
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option("--samples", options.samples, "the first so many (all)")
      ->check(CLI::Range(1, 65536));
  CLI::Option* evaluation =
      verb.add_option("--evaluation-seed", options.evaluation_seed,
                      "the seed of an evaluation: the order in which its replicate 0 takes samples")
          ->check(seed_check());
  verb.add_option("--order", options.pool.order,
                  "order of the samples: recorded (default) or shuffled by --seed")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, PoolOrder>{{"recorded", PoolOrder::kRecorded},
                                                       {"shuffled", PoolOrder::kShuffled}})
                      .description(""))
      ->option_text("recorded|shuffled")
      ->excludes(evaluation);
  verb.add_option("--seed", options.pool.seed, "seed of the order (0)")
      ->check(seed_check())
      ->excludes(evaluation);
  verb.add_option("--holdout", options.pool.holdout, "samples per pixel that are never offered (0)")
      ->check(CLI::Range(0, 65535));
  add_common(verb, program.common, true, false);
  verb.footer(
      "A sampler that took n samples of the pixel took the first n of the list.\n"
      "Examples:\n"
      "  spool pixel dumps/tiny/chess.spool --at 20,30 --samples 16\n"
      "  spool pixel dumps/tiny/chess.spool --at 20,30 --evaluation-seed 1 --json");
  verb.callback([&] { program.chosen = [&] { return run_pixel(program.pixel, program.common); }; });
}

void add_list(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("list", "what there is, with every option explained");
  verb.add_option("WHAT", program.list.what,
                  "samplers, filters, presets, views, metrics, columns, scenes, imports or exports")

      ->check(CLI::IsMember({"samplers", "filters", "presets", "views", "metrics", "columns",
                             "scenes", "imports", "exports"}));
  verb.add_flag(
      "--all", program.list.all,
      "of samplers and filters also the options that few need: readings of a text, details");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Examples:\n"
      "  spool list samplers\n"
      "  spool list filters --json | jq '.[].name'");
  verb.callback([&] { program.chosen = [&] { return run_list(program.list, program.common); }; });
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
    return unknown_name("verb", word, known_words(app, false)) + ": see spool --help";
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
  add_recover(program);
  add_pack(program);
  add_convert(program);
  add_synth(program);
  add_replay(program);
  add_reconstruct(program);
  add_evaluate(program);
  add_metrics(program);
  add_compare(program);
  add_report(program);
  add_figure(program);
  add_picture(program);
  add_pixel(program);
  add_list(program);
  try {
    program.app.parse(count, arguments);
  } catch (const CLI::Success& asked_for_help) {
    std::ostringstream text;
    program.app.exit(asked_for_help, text, text);
    print(text.str());
    const Result<void> arrived = check_output();
    if (!arrived) print_error(arrived.error());
    return arrived ? 0 : static_cast<int>(arrived.error().code);
  } catch (const CLI::ParseError& error) {
    print_error({ErrorCode::kUsage, explain(program.app, error, count, arguments)});
    return static_cast<int>(ErrorCode::kUsage);
  }
  watch_for_interrupts();
  const ThreadLimit limit(program.common.threads);
  Result<void> result = program.chosen();
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
