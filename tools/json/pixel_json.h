// What a pixel holds, as `spool pixel --json` and a live page have it.
#pragma once

#include <string>
#include <vector>

#include "tools/verbs/pixel_answer.h"

namespace spool::tools {

// "footprint", beside an image: {"taps": [[x, y, weight, R, G, B], ..],
// "shapes": [{"size", "direction", "widths"}, ..]}, or null.
std::string pixel_text(const PixelAnswer& pixel);
std::string pixels_text(const std::vector<PixelAnswer>& pixels);

}  // namespace spool::tools
