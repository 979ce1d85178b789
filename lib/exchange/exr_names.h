// Whose name is it? Channels of other renderers and tools -> layers of a dump.
//
// Known: what spool wrote itself, Blender's "VIEWLAYER.PASS.CHANNEL" (2.8 to 5), and LAYER.CHANNEL
// as OpenImageIO, Arnold, Mitsuba, pbrt and others name them; R, G, B without a layer is radiance.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/exchange/dump_layers.h"
#include "lib/image_io/exr_planes.h"

namespace spool::exchange {

struct MappedLayer {
  std::string name;                     // ours
  std::vector<std::string> components;  // ours
  std::vector<size_t> planes;           // theirs, one per component
  format::Scope scope = format::Scope::kSample;
};

struct ExrMapping {
  std::vector<MappedLayer> layers;  // radiance first
  std::vector<std::string> dropped;
};

using LayerMap = std::map<std::string, std::string>;  // ours -> theirs

// `file` opens the message. kData when there is no radiance, or a layer of `map` is not there.
Result<ExrMapping> map_exr_layers(const ExrPlanes& image, const LayerMap& map,
                                  const std::string& file);

}  // namespace spool::exchange
