// In which colours R, G, B of a file are given, and how they become those of Rec. 709.
//
// Converted where that is exact: linear values whose white is that of Rec. 709 (Rec. 2020, P3,
// Adobe RGB), and CIE XYZ. Another white (ACES) needs an adaptation, of which there are several,
// and encoded values (sRGB) are no light: both are refused by name. Statements that are looked at:
// chromaticities, colorInteropID, acesImageContainerFlag, oiio:ColorSpace; none: Rec. 709.
#pragma once

#include <optional>
#include <string>

#include "lib/core/colour.h"
#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool {

struct ColourConversion {
  std::string from;     // "Rec. 2020"
  ColourMatrix matrix;  // to linear Rec. 709

  bool operator==(const ColourConversion&) const = default;
};

// Nothing for Rec. 709 itself. kData for what is refused; `file` opens the message.
Result<std::optional<ColourConversion>> conversion_to_rec709(const ExrPart& part,
                                                             const std::string& file);

}  // namespace spool
