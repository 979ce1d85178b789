// Features for recordings in memory: an edge in the albedo, a tilted normal, a ramp of depth,
// noise.
#pragma once

#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/pool/recorded_samples.h"

namespace spool::test {

inline void add_features(RecordedSamples& recording) {
  const int width = recording.width(), spp = recording.spp();
  recording.set_features(
      {{"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "Z"}},
      [=](const FeatureLayer& layer, const Rectangle& box) -> Result<std::vector<float>> {
        std::vector<float> values;
        for (std::size_t c = 0; c < layer.components.size(); ++c) {
          for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
              for (int s = 0; s < spp; ++s) {
                double value = 0.1 * unit_double(mix(layer.name.size(), c, x, y, s));
                if (layer.name == "albedo") value += 2 * x < width ? 0.2 : 0.7;
                if (layer.name == "normal") value += c == 1 ? 0.1 * y : -0.3;
                if (layer.name == "depth") value += 3.0 + 0.2 * x + 0.1 * y;
                values.push_back(static_cast<float>(value));
              }
            }
          }
        }
        return values;
      });
}

}  // namespace spool::test
