// The one interface of all reconstructors, and their list.
//
// A reconstructor turns the statistics of a selection into an image. It must accept a bare one
// (uniform counts, no attenuation). Any reconstructor works with any sampler.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/option_table.h"
#include "lib/core/view.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

struct Reconstruction {
  RgbImage image;                    // [c][y][x] pixels, radiance units
  std::optional<RgbImage> variance;  // estimated variance of `image`, where the method has one
  std::optional<CountImage> level;   // scale chosen for each piece (its meaning is the method's)
  std::optional<Plane> dominant_direction;  // degrees mod 180, spatial; NaN where isotropic
  std::vector<std::string> notes;  // one line each, for people: what was done other than asked
  GuardCounts guards;
};

struct ReconstructionContext {
  Views* views = nullptr;                // intermediate images wanted, may be null
  const Reference* reference = nullptr;  // for oracles only, which say so in their name
  std::function<void(double)> progress;  // share of the work done, may be empty
};

// The pool is there for methods that need single samples behind the cursor (film positions,
// halves); they must not look beyond n(x, y).
using ReconstructorFunction = std::function<Result<Reconstruction>(
    const Selection&, const SamplePool&, const ReconstructionContext&)>;

struct ReconstructorEntry {
  std::string name;
  std::string summary;
  bool by_description = false;       // re-implemented from descriptions, not from the primary text
  std::vector<std::string> presets;  // the first is the default; empty: no presets
  std::string argument;              // "FILE.exr": what NAME:... takes where others have a preset
  std::function<std::vector<OptionDescription>(std::string_view preset)> describe;
  std::function<Result<ReconstructorFunction>(std::string_view preset, const OptionValues& set)>
      make;
};

const std::vector<ReconstructorEntry>& reconstructors();
// Error kUsage, with the nearest known name, when there is no such filter, preset or option.
Result<ReconstructorFunction> make_reconstructor(std::string_view name, std::string_view preset,
                                                 const OptionValues& set);

// The views that a reconstructor of the list can hand over; empty for unknown names.
std::vector<ViewDescription> reconstructor_views(std::string_view name);

}  // namespace spool
