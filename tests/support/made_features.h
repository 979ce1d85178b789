// Features for recordings in memory: an edge in the albedo, a tilted normal, a ramp of depth,
// noise.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/pool/recorded_samples.h"

namespace spool::test {

// value(layer, component, x, y, s) -> float or double, any value.
template <class Value>
void add_features(RecordedSamples& recording, Value value) {
  recording.set_features(
      {{"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "Z"}},
      [=](const FeatureLayer& layer, const Rectangle& box,
          int samples) -> Result<std::vector<float>> {
        std::vector<float> values;
        for (std::size_t c = 0; c < layer.components.size(); ++c) {
          for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
              for (int s = 0; s < samples; ++s)
                values.push_back(static_cast<float>(value(layer.name, c, x, y, s)));
            }
          }
        }
        return values;
      });
}

inline double made_feature(std::string_view layer, std::size_t c, int x, int y, int s, int width) {
  double value = 0.1 * unit_double(mix(layer.size(), c, x, y, s));
  if (layer == "albedo") value += 2 * x < width ? 0.2 : 0.7;
  if (layer == "normal") value += c == 1 ? 0.1 * y : -0.3;
  if (layer == "depth") value += 3.0 + 0.2 * x + 0.1 * y;
  return value;
}

inline void add_features(RecordedSamples& recording) {
  add_features(recording, [width = recording.width()](std::string_view layer, std::size_t c, int x,
                                                      int y, int s) {
    return made_feature(layer, c, x, y, s, width);
  });
}

}  // namespace spool::test
