// All analytic scenes by name: simple shapes, noise of every kind, and hard cases.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"
#include "lib/synthetic/analytic_scene.h"

namespace spool {

struct SyntheticOptions {
  double angle = 30.0;    // degrees from +x towards +y, of edges and streaks
  double period = 0.37;   // pixels, of the fine checker; streaks: 20 times that
  double odds = 0.004;    // of a firefly or of a sample that is not finite
  double firefly = 25.0;  // radiance a firefly adds
  double tail = 1.5;      // exponent of the heavy tail; the variance is infinite up to 2
};

const OptionTable<SyntheticOptions>& synthetic_option_table();

struct SyntheticEntry {
  std::string name;
  std::string summary;
  std::function<AnalyticScene(int width, int height, const SyntheticOptions&)> make;
};

const std::vector<SyntheticEntry>& synthetic_scenes();

// Error kUsage, with the nearest known name, when there is no such scene.
Result<AnalyticScene> synthetic_scene(std::string_view name, int width, int height,
                                      const SyntheticOptions& options = {});

}  // namespace spool
