// every_pair FILE.spool FOLDER: 6 samples a pixel by each sampler, an image by each filter, with
// the library alone, as FOLDER/SAMPLER.FILTER.exr. Samplers with a filter in their loop have `box`
// there.
#include <cstdio>
#include <filesystem>

#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/filters/filters.h"
#include "lib/image_io/exr_image.h"
#include "lib/pool/load_recording.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"

using namespace spool;

namespace {

Result<SamplingResult> sample(const Sampler& sampler, const SamplePool& pool) {
  SamplingContext context;
  OptionValues options;
  if (sampler.needs.filter_in_loop) {
    SPOOL_ASSIGN(const ReadyFilter box, make_method(filters(), {"box", "", {}}));
    context.filter = loop_filter(box);
    options = {{"filter", "box"}};
  }
  SPOOL_ASSIGN(const ReadySampler ready, sampler.make("", options));
  return ready(pool, sample_budget(6, pool.recording()), context);
}

Result<void> every_pair(const char* file, const std::filesystem::path& folder) {
  SPOOL_ASSIGN(const auto recording, load_recording(file));
  SPOOL_ASSIGN(const SamplePool pool, SamplePool::create(recording, {}));
  const auto& reference = recording->reference();
  for (const Sampler& sampler : samplers()) {
    SPOOL_ASSIGN(const SamplingResult taken, sample(sampler, pool));
    for (const Filter& filter : filters()) {
      FilterContext context;
      context.reference = reference ? &*reference : nullptr;
      SPOOL_ASSIGN(ReadyFilter whole, filter.make("", {}));
      const ReadyFilter ready = average_halves(std::move(whole));
      SPOOL_ASSIGN(const Reconstruction made, ready(taken.selection, pool, context));
      SPOOL_TRY(write_exr(folder / (sampler.name + "." + filter.name + ".exr"),
                          exr_from_rgb(made.image), {}));
    }
  }
  return {};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return static_cast<int>(ErrorCode::kUsage);
  const Result<void> done = every_pair(arguments[1], arguments[2]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
  return done ? 0 : static_cast<int>(done.error().code);
}
