#include "tools/command_line/result_verbs.h"

#include <fmt/format.h>

#include "lib/core/option_table.h"
#include "lib/experiment/reference.h"
#include "lib/experiment/result_record.h"

namespace spool::tools {
namespace {

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
          "and marked so in the column `timing`; exact: one after another (shared)")
      ->check(CLI::IsMember({"shared", "exact"}));
  verb.add_option("--shard", options.shard,
                  "i/N: only that part of the cells, for machine i of N (0/4 .. 3/4)");
  verb.add_option("--executor", options.executor,
                  "dask:ADDRESS, processes:N, or mpi below mpiexec: workers of Python's package "
                  "spool do the sampling runs");
  verb.add_flag("--merge", options.merge,
                "run nothing: make the results of the cells that are done");
  verb.add_flag("--statistics-only", options.statistics_only,
                "run nothing: compute statistics.json of these folders of results anew");
  repeatable(verb.add_option(
      "--from", options.merge_from,
      "with --merge: folders whose cells are taken over first; may be given several "
      "times"));
}

void add_judging(CLI::App& verb, EvaluateOptions& options) {
  verb.add_option("--reference", options.reference,
                  "what images are judged by: " + reference_names() +
                      " (default: the first of these that the recording can give)");
  within(verb.add_option("--holdout", options.holdout,
                         "samples per pixel kept to judge by (a quarter, at least 16, if needed)"),
         kHoldout);
  verb.add_option("--seed", options.seed, "seed of all replicates (1)")->transform(seed_check());
  verb.add_flag("--recorded-order", options.recorded_order,
                "take samples in recorded order, which is one replicate");
  within(verb.add_option("--pieces", options.pieces_per_side, kPieces), kPiecesPerSide);
  verb.add_flag("--decision-split", options.decision_split, kDecisionSplit);
  verb.add_flag("--fresh", options.fresh,
                "also apply the counts to samples that had no part in them, and take bias and "
                "variance apart: columns *_fresh, *_bias2, *_variance; three times the work");
}

}  // namespace

void add_evaluate(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "evaluate", "every sampler with every filter at every budget: error, time, pictures");
  EvaluateOptions& options = program.evaluate;
  verb.add_option("FILES", options.files,
                  "recordings; one PLAN.toml that contains everything; or, with --statistics-only, "
                  "folders of results")
      ->required();
  verb.add_option("--samplers", options.samplers, "a,b:PRESET,LABEL=c{OPTION=VALUE} (uniform)");
  verb.add_option("--filters", options.filters, "the same of filters (box)");
  verb.add_option("--spp", options.spp, "budgets in samples per pixel: 4,8,16");
  within(verb.add_option("--replicates", options.replicates,
                         "repetitions, with samples that no other has as far as they reach (8)"),
         kReplicates);
  within(verb.add_option("--repeats", options.repeats,
                         "times each stage is run for the median of its time (1)"),
         kRepeats);
  verb.add_option("--sweep-threads", options.cell_threads,
                  "run everything with each of these numbers of threads: 1,2,4");
  add_method(verb, options.methods);
  add_judging(verb, options);
  verb.add_option("--baseline", options.baseline,
                  "'SAMPLER + FILTER' that ratios are to, by their labels ('uniform + box')");
  verb.add_flag("--wide", options.wide, "print MSE, energy, times and errors at equal time too");
  verb.add_flag("--no-pictures", options.no_pictures, "numbers only");
  add_parts_of_a_run(verb, options);
  verb.add_option("--export-inputs", options.inputs,
                  "write DIR/{recording}_{spp}_{replicate}.exr (image, variance, features) for a "
                  "denoiser elsewhere, and no results; its images come back as the filter "
                  "image:DIR/{recording}_{spp}_{replicate}.exr");
  verb.add_option("-o,--output", options.output, "folder for the results and the pictures");
  group_options(verb, "What is compared",
                {"--samplers", "--filters", "--spp", "--preset", "--set", "--baseline"});
  group_options(verb, "How it is judged",
                {"--replicates", "--reference", "--holdout", "--seed", "--recorded-order",
                 "--pieces", "--decision-split", "--fresh"});
  group_options(verb, "What is written",
                {"--output", "--wide", "--no-pictures", "--export-inputs"});
  group_options(verb, "Time and machines",
                {"--repeats", "--sweep-threads", "--timing", "--dry-run", "--shard", "--executor",
                 "--merge", "--from", "--statistics-only"});
  add_common(verb, program.common, true, true);
  verb.footer(
      "results.csv and results.jsonl have one row per recording, sampler, filter, budget and "
      "replicate: spool list columns. A run that was interrupted goes on when started again; "
      "--force starts it anew. MSE is debiased by the variance of the reference and may be "
      "slightly negative. `pool` judges an image by the samples it was made of: biased, and "
      "differently for each method.\n"
      "Examples:\n"
      "  spool evaluate dumps/tiny/chess.spool --samplers uniform,multiscale \\\n"
      "    --filters box,directional --spp 4,8,16 -o results\n"
      "  spool evaluate tools/plans/quick.toml -o results\n"
      "  spool evaluate plan.toml --dry-run\n"
      "  spool evaluate --statistics-only results\n"
      "  spool evaluate plan.toml --shard 3/16 -o shared/results   (machine 3 of 16)\n"
      "  spool evaluate plan.toml --merge -o shared/results        (when all are done)");
  runs(verb, program, run_evaluate, program.evaluate);
}

void add_metrics(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("metrics", "every metric of one image against another");
  MetricsOptions& options = program.metrics;
  verb.add_option("IMAGE", options.image, "an EXR: R, G, B or Y, scene-linear")->required();
  verb.add_option("REFERENCE", options.reference, "an EXR of the same size")->required();
  verb.add_option(
      "--variance", options.variance,
      "EXR with the variance of the reference's mean (its layer variance, where it has one): "
      "errors are debiased by it");
  repeatable(
      verb.add_option("--mask", options.masks,
                      "NAME=FILE.exr: energy ratio where the mask is above 0.5; several times"));
  repeatable(
      verb.add_option("--set", options.settings,
                      "OPTION=VALUE of the metrics (spool list metrics), but for perceptual=all: "
                      "rel_scale=none"));
  add_layer(verb, options.layer, "", "of IMAGE");
  add_layer(verb, options.reference_layer, "reference-", "of REFERENCE");
  verb.add_option("--error-map", options.error_map, "also write the squared error of each pixel");
  add_common(verb, program.common, true, true);
  verb.footer(
      "Examples:\n"
      "  spool metrics mine.exr reference.exr\n"
      "  spool metrics mine.exr reference.exr --json --set rel_scale=none");
  runs(verb, program, run_metrics, program.metrics);
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
  within(verb.add_option(
             "--significance", options.significance,
             "chance of a claim where nothing changed, of all comparisons together (0.05)"),
         kSignificance);
  verb.add_option("--match", options.match_name,
                  "label: methods as tables call them, by their own label or with their options; "
                  "name: whatever their labels and options (label)")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, bool>{{"label", false}, {"name", true}}));
  within(verb.add_option("--tolerance", options.tolerance,
                         "relative changes up to this are let pass: 0.01 (0)"),
         kTolerance);
  verb.add_flag("--all", options.all, "also list what did not change");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Exit code 1 when something became worse, failed, is missing or incomplete in AFTER, or was "
      "judged by another reference, other samples held out or other options of metrics, which is "
      "not compared: for a build machine. Differences are paired where both drew the same "
      "samples.\n"
      "Examples:\n"
      "  spool evaluate plan.toml -o new && spool compare accepted new\n"
      "  spool compare accepted new --metric relmse,cpu --tolerance 0.02\n"
      "  spool compare alpha_03 alpha_04 --match name");
  runs(verb, program, run_compare, program.compare);
}

void add_report(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "report", "one HTML file of an evaluation: results at a glance, charts, table, images");
  ReportOptions& options = program.report;
  verb.add_option("DIR", options.folder, "the folder that spool evaluate -o DIR wrote")->required();
  add_output(verb, options.output, "the HTML file; it needs no network and no other file");
  verb.add_option("--metric", options.metric, "the error that the summary compares (relmse)");
  within(
      verb.add_option("--max-image-mb", options.max_image_mb,
                      "megabytes of images in the page; beyond, crops and links to the EXRs (40)"),
      kImageMb);
  verb.add_option("--title", options.title, "heading of the page (names of the recordings)");
  add_common(verb, program.common, false, true);
  verb.footer(
      "Needs Python 3 with numpy (SPOOL_PYTHON names the interpreter) and, once, the scripts that "
      "tools/report/fetch_assets.sh fetches.\n"
      "Examples:\n"
      "  spool report results -o report.html\n"
      "  spool report results -o report.html --metric mse --title 'Two filters'");
  runs(verb, program, run_report, program.report);
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
  within(verb.add_option("--spp", options.spp, "budget of the comparisons, 0 for the largest (0)"),
         kFigureSpp);
  verb.add_option("--recording", options.recordings, "compare on this one; may be given again");
  repeatable(verb.add_option(
      "--method", options.methods,
      "'SAMPLER + FILTER' to show, in this order; may be given again, eight times at "
      "most (your own methods, the baseline, the best of the others)"));
  repeatable(
      verb.add_option("--crops", options.crops,
                      "[RECORDING:]X,Y,W,H: a window to show, in pixels; may be given again, four "
                      "times at most (two where methods differ to the eye)"));
  within(
      verb.add_option(
          "--column", options.column,
          "columns of a paper that a figure is as wide as: 1, 3.33 inches; 2, 7 inches; 0, 1 for "
          "curves of one recording and else 2 (0)"),
      kColumns);
  verb.add_option("--font", options.font,
                  "latex: text set by LaTeX, in its own font; latex:PACKAGE: in that of a package, "
                  "libertine for example");
  group_options(verb, "Layout", {"--crops", "--column", "--font"});
  add_common(verb, program.common, false, true);
  verb.footer(
      "Writes comparison_RECORDING (reference, windows, error maps, numbers), comparison "
      "(recordings "
      "as rows), curves and curves_time, each as .pdf, .svg and .png; captions.tex, table.tex and "
      "table.md; curves.csv and curves.py, which draws it. Bold: the best, where separated "
      "from every other. Needs Python 3 with numpy and matplotlib.\n"
      "Examples:\n"
      "  spool figure results -o figures\n"
      "  spool figure results -o figures --column 1 --font latex --crops 12,20,16,16\n"
      "  spool figure results -o figures --spp 4 --method 'uniform + box' \\\n"
      "    --method 'multiscale + directional'\n"
      "  spool figure tools/plans/quick.toml -o figures");
  runs(verb, program, run_figure, program.figure);
}

}  // namespace spool::tools
