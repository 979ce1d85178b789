// What is told of a pixel as JSON: its samples in the order in which a replay takes them, their
// running mean with its interval, a histogram of their luminance; the footprint of a filter.
#pragma once

#include <nlohmann/json.hpp>

#include "lib/core/footprint.h"
#include "lib/pool/sample_pool.h"

namespace spool::tools {

// Of the first `most` samples; 0: all. (x, y) must lie in the pool, whose pieces are pixels.
nlohmann::ordered_json pixel_answer(const SamplePool& pool, int x, int y, int most);

// {"taps": [[x, y, weight, R, G, B], ..], "shapes": [{"size", "direction", "widths"}, ..]}
nlohmann::ordered_json footprint_answer(const Footprint& footprint);

}  // namespace spool::tools
