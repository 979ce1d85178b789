// What the formats made of EXR images share: layers of a recording as arrays on disk, and the text
// that describes them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/file_handle.h"
#include "formats/interchange/dump_import.h"
#include "formats/spool_reader.h"
#include "lib/core/error.h"
#include "lib/image_io/exr_layers.h"
#include "lib/image_io/exr_planes.h"

namespace spool::exchange {

PixelType pixel_type(format::DataType type);
interchange::ElementType element_type(PixelType type);

// The planes of a layer as [y][x][c], bit for bit where they have the type of the layer; half
// floats may become floats.
std::vector<std::byte> interleaved(std::span<const ExrPlane> planes, PixelType type);

// kData when blocks are missing: an image has no place for holes.
Result<void> require_complete(const format::SpoolReader& dump);

// A layer at an offset of a scratch file: [y][x][s][c], pixel scope [y][x][c], pass scope [s][c].
struct ScratchLayer {
  format::LayerInfo layer;
  uint64_t offset = 0;
};
struct ScratchLayers {
  format::FileHandle file;
  std::vector<ScratchLayer> layers;
};
// Lays out all layers of `dump` beside `out`.
Result<ScratchLayers> unpack_layers(const format::SpoolReader& dump,
                                    const std::filesystem::path& out);

// Attributes that let an EXR come back as the recording it was: spoolVersion, spoolChannels,
// spoolMeta, spoolSampleOrder, spoolSource.
ExrAttributes describe_dump(const format::SpoolReader& dump);
// spoolSource: the recording that an image was exported from; empty where it has none.
std::string source_of(const ExrAttributes& attributes);

struct ToldChannel {
  std::string layer, component;
  format::Scope scope = format::Scope::kSample;
  uint16_t semantic = 0;
  std::string name() const { return layer + "." + component; }
};
// What describe_dump() wrote.
struct ToldDump {
  std::vector<ToldChannel> channels;
  nlohmann::json meta = nlohmann::json::object();
  format::SampleOrder sample_order = format::SampleOrder::kRenderer;
  std::optional<double> samples;  // of every pixel, where the attributes say it
  bool has_pixel_layers() const;
  std::vector<uint16_t> semantics(const std::string& layer) const;  // empty: none are given
};
// kData when the attributes are there and make no sense, or describe no recording; nullopt when
// there are none.
Result<std::optional<ToldDump>> told_dump(const ExrAttributes& attributes, const std::string& name);

}  // namespace spool::exchange
