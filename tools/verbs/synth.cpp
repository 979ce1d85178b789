#include "tools/verbs/synth.h"

#include <utility>

#include "lib/core/counted.h"
#include "lib/image_io/atomic_file.h"
#include "lib/synthetic/write_synthetic.h"
#include "tools/terminal/interrupt.h"
#include "tools/terminal/progress.h"
#include "tools/verbs/option_bounds.h"

namespace spool::tools {
namespace {

constexpr int kLargestSide = 65536;

Result<std::pair<int, int>> parse_size(const std::string& text) {
  const std::size_t cross = text.find('x');
  const std::string width_text = text.substr(0, cross);
  const auto width = parse_integer("--size", width_text, 1, kLargestSide);
  const auto height =
      cross == std::string::npos
          ? width
          : parse_integer("--size", std::string_view(text).substr(cross + 1), 1, kLargestSide);
  if (!width || !height) {
    return fail(ErrorCode::kUsage, "--size {}: write WxH or N, from 1 to {} pixels", text,
                kLargestSide);
  }
  return std::pair{*width, *height};
}

}  // namespace

Result<void> validate(const SynthOptions& options) {
  SPOOL_TRY(parse_size(options.size));
  SPOOL_TRY(check_bounds("samples", options.spp, kSamples));
  return check_seed(options.seed);
}

Result<void> synthesise(const SynthOptions& options, bool force,
                        const std::function<void(double)>& progress) {
  SPOOL_TRY(validate(options));
  SPOOL_TRY(refuse_existing(options.output, force));
  SPOOL_ASSIGN(const auto size, parse_size(options.size));
  WriteSyntheticOptions write;
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      return fail(ErrorCode::kUsage, "--set {}: write OPTION=VALUE, for example angle=45", setting);
    }
    SPOOL_TRY(set_option(synthetic_option_table(), write.scene, setting.substr(0, equals),
                         setting.substr(equals + 1)));
  }
  write.writer.compress = options.compress;
  write.writer.force = force;
  write.writer.discard_unfinished = true;  // the same command makes it again
  write.progress = progress;
  return write_synthetic(options.scene, size.first, size.second, options.spp, options.seed,
                         options.output, write);
}

Result<void> run_synth(const SynthOptions& options, const CommonOptions& common) {
  Progress progress("synth " + options.scene, common.quiet);
  const InterruptNote note([&] {
    return "nothing is kept of " + options.output.string() + ": the same command starts anew";
  });
  SPOOL_TRY(synthesise(options, common.force, [&](double share) { progress.update(share); }));
  if (!common.quiet) {
    SPOOL_ASSIGN(const auto size, parse_size(options.size));
    print_line(fmt::format("{}: {} x {} pixels, {} each, exact reference", options.output.string(),
                           size.first, size.second, counted(options.spp, "sample")));
  }
  return {};
}

}  // namespace spool::tools
