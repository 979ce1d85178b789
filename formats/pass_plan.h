// Which planes of recorded passes go into which group of the recording, and how the image is cut.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/dump_header.h"
#include "formats/pass_manifest.h"
#include "lib/core/error.h"

namespace spool::format {

struct PackOptions {
  bool compress = false;
  bool force = false;  // replace the target
  bool remove_passes =
      false;  // each when the recording has taken it: the disk holds no sample twice
  bool radiance_f16 = false;  // f32 by default: fireflies pass 65504, and rounding adds variance
  bool features_f32 = false;  // f16 by default, where the recorder says that f16 is enough
  uint32_t tile_size = 64;
  uint32_t block_spp = 0;        // 0: 16, or fewer if memory_bytes or spp ask for it
  uint64_t max_expansion = 100;  // of packed passes: their values against their files
  uint64_t memory_bytes = uint64_t{512} << 20;
  std::optional<std::array<uint8_t, 16>> uuid;
};

// Planes of a pass file that go into one group of scope sample.
struct SampleGroup {
  uint16_t group = 0;
  DataType type = DataType::kFloat32;
  std::vector<uint32_t> planes;

  uint64_t bytes_per_sample() const { return planes.size() * bytes_per_value(type); }
};

struct DumpPlan {
  DumpHeader header;
  std::vector<SampleGroup> groups;
  uint16_t film = 0;  // group numbers; 0: none, radiance has that one
  uint16_t seed = 0;
  uint16_t reference = 0;
};

struct Tile {
  uint32_t number = 0;
  uint32_t x0 = 0;
  uint32_t y0 = 0;
  uint32_t width = 0;
  uint32_t height = 0;
};

// kData: more passes than a recording holds.
Result<DumpPlan> plan_dump(const PassManifest& manifest, const PackOptions& options);

// The tiles of row `band` of tiles, cropped to the image.
std::vector<Tile> tiles_of_band(const DumpHeader& header, uint32_t band);

}  // namespace spool::format
