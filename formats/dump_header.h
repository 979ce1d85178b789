// What a recording is, in memory: geometry and channels of one .spool file.
//
// A DumpHeader that a reader hands out keeps every rule of formats/spool.md 4.1, 4.2 and 6; a
// writer refuses one that does not.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/record_layout.h"

namespace spool::format {

struct ChannelInfo {
  std::string name;  // "layer.component", e.g. "radiance.R"
  uint16_t group = 0;
  DataType type = DataType::kFloat32;
  uint16_t semantic = 0;  // a value of Semantic
  Scope scope = Scope::kSample;

  bool operator==(const ChannelInfo&) const = default;
};

struct DumpHeader {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t tile_size = 64;
  uint32_t spp = 0;        // samples declared per pixel
  uint32_t block_spp = 0;  // samples per block; the last block of a pixel may be shorter
  PixelFilter pixel_filter = PixelFilter::kBox;
  ColourSpace colour_space = ColourSpace::kLinearRec709;
  SampleOrder sample_order = SampleOrder::kRenderer;
  std::vector<ChannelInfo> channels;  // sorted by group; group 0 is radiance.R, .G, .B
  std::array<uint8_t, 16> uuid{};     // set by the writer (WriterOptions::uuid, else random)

  bool operator==(const DumpHeader&) const = default;
};

// Half-open: x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
  uint32_t x0 = 0;
  uint32_t y0 = 0;
  uint32_t x1 = 0;
  uint32_t y1 = 0;

  uint32_t width() const { return x1 - x0; }
  uint32_t height() const { return y1 - y0; }
  bool operator==(const PixelRect&) const = default;
};

// A run of neighbouring channels with the same name before the dot.
struct LayerInfo {
  std::string name;
  uint16_t group = 0;
  uint32_t first_channel = 0;  // position on the channel axis of the group's blocks
  uint32_t channel_count = 0;
  DataType type = DataType::kFloat32;
  Scope scope = Scope::kSample;
  std::vector<std::string> components;  // "R", "G", "B"
};

constexpr uint32_t bytes_per_value(DataType type) {
  return type == DataType::kFloat16 ? 2 : 4;
}

// The three mandatory channels of group 0.
inline std::vector<ChannelInfo> radiance_channels(DataType type = DataType::kFloat32) {
  const auto light = static_cast<uint16_t>(Semantic::kLight);
  return {{"radiance.R", 0, type, light, Scope::kSample},
          {"radiance.G", 0, type, light, Scope::kSample},
          {"radiance.B", 0, type, light, Scope::kSample}};
}

}  // namespace spool::format
