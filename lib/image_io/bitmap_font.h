// A small bitmap font for titles and scales: 5 x 7 dots a character, drawn for this project.
#pragma once

#include <string_view>

#include "lib/image_io/picture.h"

namespace spool {

inline constexpr int kGlyphAdvance = 6;  // dots per character, the gap included
inline constexpr int kGlyphHeight = 9;   // dots per line: 7, and 2 for what hangs below

int text_width(std::string_view text, int scale);

// Draws `text` with its upper left corner at (left, top); a dot is `scale` x `scale` pixels.
// Characters outside printable ASCII are drawn as '?'.
void draw_text(Picture& target, std::string_view text, int left, int top, int scale, Rgb8 colour);

}  // namespace spool
