#include "tools/command_line/recording_verbs.h"

#include <fmt/format.h>

#include "lib/core/option_table.h"
#include "lib/exchange/foreign_formats.h"
#include "lib/synthetic/synthetic_scenes.h"

namespace spool::tools {

void add_info(Program& program) {
  CLI::App& verb = *program.app.add_subcommand("info", "what was recorded");
  add_dump(verb, program.info.dump);
  verb.add_flag("--all", program.info.all,
                "every channel, claim of verification and remark, and the file's SHA-256");
  add_common(verb, program.common, true, false);
  verb.footer(
      "Examples:\n"
      "  spool info dumps/tiny/chess.spool\n"
      "  spool info dumps/tiny/chess.spool --all\n"
      "  spool info dumps/tiny/chess.spool --json | jq .samples_per_pixel");
  runs(verb, program, run_info, program.info);
}

void add_check(Program& program) {
  CLI::App& verb = *program.app.add_subcommand("check", "verify every record of a recording");
  add_dump(verb, program.check.dump);
  add_common(verb, program.common, true, false);
  verb.footer(
      "Exit code 4 and a list of what is lost when the file is damaged or incomplete.\n"
      "Examples:\n"
      "  spool check dumps/tiny/chess.spool\n"
      "  for f in *.spool; do spool check -q $f || echo \"$f is damaged\"; done");
  runs(verb, program, run_check, program.check);
}

void add_recover(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "recover", "all intact records of a damaged recording, as a new one");
  verb.add_option("IN", program.recover.input, "a cut or damaged recording")->required();
  verb.add_option("OUT", program.recover.output, "the recording to write")->required();
  add_common(verb, program.common, true, true);
  verb.footer(
      "Exit code 4 and a list of what is lost when anything is. What the new file holds is whole; "
      "to spool check the blocks that were lost are ones that were never recorded.\n"
      "Examples:\n"
      "  spool recover damaged.spool saved.spool\n"
      "  spool recover night.spool.partial saved.spool  (an interrupted recording)");
  runs(verb, program, run_recover, program.recover);
}

void add_pack(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "pack", "folders of recorded passes, or a foreign file, become one recording");
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
  add_output(verb, program.pack.output, "the recording to write, NAME.spool");
  verb.add_flag("--compress", pack.compress, "zstd, where it saves 5 % or more");
  verb.add_flag("--half-radiance", pack.radiance_f16, "radiance as 16-bit floats (32)");
  verb.add_flag("--full-features", pack.features_f32, "features as 32-bit floats (16)");
  verb.add_flag("--remove-passes", pack.remove_passes,
                "each pass when the recording has taken it: the disk holds no sample twice");
  repeatable(verb.add_option(
      "--set", program.pack.settings,
      "import.OPTION=VALUE, an option of the foreign format: see spool list imports"));
  add_layer(verb, program.pack.layer, "", "of each image (--from exr-folder)");
  constexpr std::uint64_t kMost = interchange::kMaxExpansionTimes;
  within(verb.add_option("--max-expansion", program.pack.max_expansion,
                         "how many times larger than its source the recording may be (100)"),
         {1, kMost})
      ->check(CLI::Range(std::uint64_t{1}, kMost).description(""));
  group_options(verb, "Foreign files", {"--from", "--set", "--layer", "--part"});
  add_common(verb, program.common, true, true);
  verb.footer(
      "docs/formats.md lists what each foreign format holds and what is converted or dropped.\n"
      "Examples:\n"
      "  spool pack chess.passes -o chess.spool\n"
      "  spool pack machine1.passes machine2.passes --compress -o chess.spool\n"
      "  spool pack --from npz samples.npz --set import.layout=HWSC -o mine.spool\n"
      "  spool pack --from exr-folder renders --set import.map=albedo=DiffCol \\\n"
      "    -o mine.spool");
  runs(verb, program, run_pack, program.pack);
}

void add_convert(Program& program) {
  CLI::App& verb =
      *program.app.add_subcommand("convert", "a recording becomes a neighbour's file or folder");
  ConvertOptions& options = program.convert;
  verb.add_option("IN", options.input, "a recording, NAME.spool")->required();
  const std::vector<std::string> kinds = names_of(exchange::export_formats());
  verb.add_option("--to", options.to, fmt::format("{}", fmt::join(kinds, ", ")))
      ->required()
      ->check(CLI::IsMember(kinds).description(""))
      ->option_text("FORMAT");
  repeatable(
      verb.add_option("--set", options.settings,
                      "export.OPTION=VALUE, an option of the format: see spool list exports"));
  add_output(verb, options.output,
             "npz, bcd, deep-exr: the file; bcd-stats: P.exr, P_cov.exr, P_hist.exr; exr-folder, "
             "oidn: the folder");
  add_common(verb, program.common, true, true);
  verb.footer(
      "What a format has no place for is an error or named; see docs/formats.md.\n"
      "Examples:\n"
      "  spool convert dumps/tiny/chess.spool --to npz -o chess.npz\n"
      "  spool convert chess.spool --to oidn --set export.spp=1,2,4,8 -o oidn_set\n"
      "  spool convert chess.spool --to bcd-stats --set export.spp=16 -o chess_bcd");
  runs(verb, program, run_convert, program.convert);
}

void add_synth(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "synth", "an analytic scene with its exact reference, as a recording; needs no renderer");
  SynthOptions& options = program.synth;
  verb.add_option("NAME", options.scene, "see spool list scenes")->required();
  verb.add_option("--size", options.size, "WxH or N pixels (128x128)");
  within(verb.add_option("--samples", options.spp, "per pixel (64)"), kSamples);
  verb.add_option("--seed", options.seed, "of the samples (1)")->transform(seed_check());
  repeatable(verb.add_option("--set", options.settings,
                             "OPTION=VALUE of the scene: see spool list scenes"));
  verb.add_flag("--compress", options.compress, "zstd, where it saves 5 % or more");
  add_output(verb, options.output, "the recording to write, NAME.spool");
  add_common(verb, program.common, false, true);
  verb.footer(
      "Examples:\n"
      "  spool synth scene_s --size 128 --samples 64 -o s.spool\n"
      "  spool synth slanted_edge --set angle=45 -o edge.spool");
  runs(verb, program, run_synth, program.synth);
}

}  // namespace spool::tools
