// The one interface of all filters.
//
// A filter turns the statistics of a selection into an image. It must accept a bare one (uniform
// counts, no attenuation). Any filter works with any sampler.
// The filters of the library: lib/filters/filters.h.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/footprint.h"
#include "lib/core/guards.h"
#include "lib/core/view.h"
#include "lib/methods/method.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

struct Reconstruction {
  RgbImage image;                    // [c][y][x] pixels, radiance units
  std::optional<RgbImage> variance;  // estimated variance of `image`, where the method has one
  std::optional<CountImage> level;   // scale chosen for each piece (its meaning is the method's)
  std::optional<Plane> dominant_direction;  // degrees mod 180, spatial; NaN where isotropic
  std::vector<std::string> notes;  // one line each, for people: what was done other than asked
  double exchange_seconds = 0;     // of its time: starting a command and handing files over
  GuardCounts guards;
};

struct FilterContext {
  Views* views = nullptr;                // intermediate images wanted, may be null
  const Reference* reference = nullptr;  // for oracles only, which say so in their needs
  std::function<void(double)> progress;  // share of the work done, may be empty
  Footprints* footprints = nullptr;      // weights wanted of single pixels, may be null
  // False: the variance of the image is not asked for. A filter whose needs allow it then gets
  // means alone: the other planes of the statistics are empty.
  bool variance = true;
};

// Pixels whose weights are returned, (x, y).
inline std::vector<std::pair<int, int>> wanted_pixels(const FilterContext& context) {
  return context.footprints ? context.footprints->wanted() : std::vector<std::pair<int, int>>{};
}

// The pool is there for methods that need single samples behind the cursor (film positions,
// halves); they must not look beyond n(x, y).
using FilterFunction = std::function<Result<Reconstruction>(const Selection&, const SamplePool&,
                                                            const FilterContext&)>;
using Filter = Method<FilterFunction>;
using ReadyFilter = Ready<FilterFunction>;

}  // namespace spool
