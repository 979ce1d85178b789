// What judging makes of the reference alone: once for all the images that are judged by it.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>

#include "lib/core/image.h"
#include "lib/metrics/flip.h"

namespace spool {

struct ReferenceSide {
  Image<std::uint8_t> judged;  // the pixels that it was made of
  double exposure = 1.0;       // tone_map_exposure
  RgbImage tone;               // tone-mapped
  FlipView flip;               // at that exposure
  Image<std::uint8_t> decile;  // of the denominator's luminance
};

// Which of them are needed; `exposure` goes with tone and flip.
struct SideParts {
  bool tone = false, flip = false, deciles = false;
};

// `denominator`: the image whose noise is independent of the reference's where that is noisy, else
// a decile of bright pixels would hold those that the reference has too bright.
ReferenceSide reference_side(const RgbImage& mean, const RgbImage& denominator,
                             const Image<std::uint8_t>& judged, SideParts parts);

// That of the last reference, kept for the images that judge the same pixels. For one reference;
// safe from several threads.
class KeptSide {
 public:
  std::shared_ptr<const ReferenceSide> of(const RgbImage& mean, const RgbImage& denominator,
                                          const Image<std::uint8_t>& judged, SideParts parts);

 private:
  std::mutex mutex_;  // not held while a side is made: loops of other images may run meanwhile
  std::shared_ptr<const ReferenceSide> side_;
};

}  // namespace spool
