#include "lib/filters/given_image.h"

#include <cmath>
#include <utility>

namespace spool {

Result<Reconstruction> own_image(RgbImage image, const SamplePool& pool, const std::string& name) {
  const RecordedSamples& recording = pool.recording();
  if (image[0].width() != recording.width() || image[0].height() != recording.height()) {
    return fail(ErrorCode::kData,
                "{}: {} x {} pixels, the recording has {} x {}: give an image of the same size",
                name, image[0].width(), image[0].height(), recording.width(), recording.height());
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < image[c].size(); ++p) {
      if (std::isfinite(image[c][p])) continue;
      const auto width = static_cast<std::size_t>(image[c].width());
      return fail(ErrorCode::kData,
                  "{}: holds {} in channel {} (pixel {}, {}): every value must be finite", name,
                  image[c][p], "RGB"[c], p % width, p / width);
    }
  }
  Reconstruction result;
  result.image = std::move(image);
  return result;
}

FilterFunction given_image(RgbImage image, std::string name) {
  return [image = std::move(image), name = std::move(name)](
             const Selection&, const SamplePool& pool,
             const FilterContext&) -> Result<Reconstruction> {
    if (pool.is_half()) {
      return fail(
          ErrorCode::kUsage,
          "{}: is the same for any samples: a sampler with it in its loop gains nothing from it, "
          "and crossfit and split decisions want an image of each half: put a filter there",
          name);
    }
    return own_image(image, pool, name);
  };
}

}  // namespace spool
