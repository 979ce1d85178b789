// Which components a layer has: of three others, or in another order, a picture has other colours.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "formats/dump_header.h"

namespace spool::format {

// Whether they are these letters in their order: "RGB", "XY".
inline bool has_components(const LayerInfo& layer, std::string_view letters) {
  return std::ranges::equal(layer.components, letters, [](const std::string& name, char letter) {
    return name.size() == 1 && name[0] == letter;
  });
}

}  // namespace spool::format
