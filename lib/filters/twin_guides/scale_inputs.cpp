#include "lib/filters/twin_guides/scale_inputs.h"

#include <utility>

namespace spool {

ScaleInputs finest_inputs(SampleMoments moments, std::vector<Image<float>> raw_features) {
  const Image<float> nowhere(moments.log_luminance.width(), moments.log_luminance.height());
  return {std::move(moments.mean),
          std::move(moments.difference),
          std::move(moments.log_luminance),
          nowhere,
          nowhere,
          std::move(raw_features)};
}

ScaleInputs empty_inputs(int width, int height, std::size_t features) {
  const Image<float> empty(width, height);
  return {{empty, empty, empty},
          {empty, empty, empty},
          empty,
          empty,
          empty,
          std::vector<Image<float>>(features, empty)};
}

ScaleImages empty_images(int width, int height) {
  const Image<float> empty(width, height);
  return {{empty, empty, empty}, {empty, empty, empty}};
}

}  // namespace spool
