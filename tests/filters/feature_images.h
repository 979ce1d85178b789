// Feature images for tests, and the way between float images and planes.
#pragma once

#include "lib/filters/twin_guides/feature_blend.h"
#include "tests/reference/test_images.h"
#include "tests/reference/twin_guides_reference.h"

namespace spool::testing {

inline Image<float> to_float(const Plane& plane) {
  Image<float> image(plane.width(), plane.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    image[i] = static_cast<float>(plane[i]);
  return image;
}

inline Plane to_double(const Image<float>& image) {
  Plane plane(image.width(), image.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = image[i];
  return plane;
}

inline reference::Planes to_double(const std::vector<Image<float>>& images) {
  reference::Planes planes;
  for (const Image<float>& image : images)
    planes.push_back(to_double(image));
  return planes;
}

// Features with an edge and noise of an unequal, known size.
inline FeatureImages noisy_features(int width, int height, std::size_t channels) {
  FeatureImages features;
  for (std::size_t c = 0; c < channels; ++c) {
    Plane value = reference::noise_image(width, height, 10 + c);
    Plane variance = reference::noise_image(width, height, 20 + c);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        value(x, y) = 0.1 * value(x, y) + (2 * x + y > width ? 0.5 : 0.0);
        variance(x, y) = 0.02 * variance(x, y) * variance(x, y);
      }
    }
    features.value.push_back(to_float(value));
    features.variance.push_back(to_float(variance));
  }
  return features;
}

}  // namespace spool::testing
