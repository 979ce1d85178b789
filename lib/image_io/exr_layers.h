// The layers of an OpenEXR file: channels of a part that belong together by their names.
//
// "LAYER.CHANNEL"; a channel without a layer belongs to the layer that its part is named after. A
// view stands at the end of a layer or is an attribute of the part (OpenEXR: "Multi-View OpenEXR").
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/image_io/exr_types.h"
#include "lib/image_io/layer_kinds.h"

namespace spool {

struct ExrLayer {
  std::size_t part = 0;
  std::string name;    // "" where neither the channels nor the part have one
  std::string before;  // of the name: the view layer of Blender
  std::string pass;    // its last component, without the view
  std::string view;    // "" for the default one
  LayerKind kind = LayerKind::kUnknown;
  std::map<std::string, std::size_t> channels;       // as spelt -> index in the part
  std::optional<std::array<std::size_t, 3>> colour;  // R, G, B
  std::optional<std::size_t> grey;                   // the channel of a picture without colours

  bool is_picture() const { return colour || grey; }
};

// The last component and what stands before it: ("radiance", "R").
std::pair<std::string, std::string> split_channel(const std::string& name);

std::vector<ExrLayer> layers_of(const std::vector<ExrPart>& parts);

// "beauty", the only channel "depth.Z", or "R,G,B" without a name: as --layer takes it.
std::string spelt(const ExrLayer& layer);
// With the part where several have a layer of that name: "diffuse of part 2 'left'".
std::string told(const ExrLayer& layer, const std::vector<ExrPart>& parts,
                 const std::vector<ExrLayer>& layers);

// "a, b, c and 12 more": so many that a line stays one that is read.
std::string listed(const std::vector<std::string>& names);

}  // namespace spool
