// replay_and_reconstruct FILE.spool IMAGE.exr: 8 samples a pixel where `multiscale` puts them,
// then a directional filter.
#include <cstdio>

#include "lib/filters/filters.h"
#include "lib/image_io/exr_image.h"
#include "lib/pool/load_recording.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"

using namespace spool;

Result<void> replay_and_reconstruct(const char* dump, const char* image) {
  SPOOL_ASSIGN(const auto recording, load_recording(dump));
  SPOOL_ASSIGN(const SamplePool pool, SamplePool::create(recording, {}));
  SPOOL_ASSIGN(const ReadySampler sample, make_method(samplers(), {.name = "multiscale"}));
  SPOOL_ASSIGN(const SamplingResult taken,
               sample(pool, sample_budget(8, *recording), SamplingContext{}));
  SPOOL_ASSIGN(const ReadyFilter filter, make_method(filters(), {.name = "directional"}));
  SPOOL_ASSIGN(const Reconstruction result, filter(taken.selection, pool, FilterContext{}));
  std::printf("%lld samples taken\n", taken.log.spent);
  return write_exr(image, exr_from_rgb(result.image), {.overwrite = true});
}

int main(int count, char** arguments) {
  if (count != 3) return static_cast<int>(ErrorCode::kUsage);
  const Result<void> done = replay_and_reconstruct(arguments[1], arguments[2]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
  return done ? 0 : static_cast<int>(done.error().code);
}
