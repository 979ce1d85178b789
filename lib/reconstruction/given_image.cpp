#include "lib/reconstruction/given_image.h"

#include <utility>

namespace spool {

ReconstructorFunction given_image(RgbImage image, std::string name) {
  return [image = std::move(image), name = std::move(name)](
             const Selection&, const SamplePool& pool,
             const ReconstructionContext&) -> Result<Reconstruction> {
    const RecordedSamples& recording = pool.recording();
    if (image[0].width() != recording.width() || image[0].height() != recording.height()) {
      return fail(ErrorCode::kData,
                  "{}: {} x {} pixels, the recording has {} x {}: give an image of the same size",
                  name, image[0].width(), image[0].height(), recording.width(), recording.height());
    }
    Reconstruction result;
    result.image = image;
    return result;
  };
}

}  // namespace spool
