// Whose name is it? Channels of other renderers and tools -> layers of a recording.
//
// Known: what spool wrote itself, Blender's "VIEWLAYER.PASS.CHANNEL" (2.8 to 5), and LAYER.CHANNEL
// as OpenImageIO, Arnold, Mitsuba, pbrt and others name them. Radiance is the picture of the file
// (lib/image_io/layer_choice.h), features are those of its view layer and view.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/exchange/dump_layers.h"
#include "lib/image_io/colour_space.h"
#include "lib/image_io/layer_choice.h"

namespace spool::exchange {

using ForeignChannel = std::pair<size_t, size_t>;  // part, channel in it

struct MappedLayer {
  std::string name;                                 // ours
  std::vector<std::string> components;              // ours
  std::vector<ForeignChannel> planes;               // theirs, one per component
  PixelType type = PixelType::kFloat;               // of all components together
  std::optional<ColourConversion> conversion = {};  // of colours that are not those of Rec. 709
  std::vector<uint16_t> semantics = {};             // of the components; empty: by the name

  bool is_colour() const { return components == std::vector<std::string>{"R", "G", "B"}; }
};

struct ExrMapping {
  std::vector<MappedLayer> layers;     // radiance first
  std::vector<std::string> dropped;    // every channel
  std::vector<std::string> converted;  // one line each, also for the user
  std::vector<std::string> notes;      // one line each, for the user
};

struct LayerMap {
  std::map<std::string, std::string> layers;  // ours -> theirs
  LayerChoice radiance;                       // the layer and the part that are the picture
};

// `file` opens the message. kData when there is no radiance or more than one, when a layer of `map`
// is not there, when components have types that do not fit.
Result<ExrMapping> map_exr_layers(const std::vector<ExrPart>& parts, const LayerMap& map,
                                  const std::string& file);

}  // namespace spool::exchange
