// Tiles, blocks and sizes that follow from a DumpHeader.
//
// A *slot* numbers every block a complete recording has: group by group, in a group tile by tile,
// in a tile block by block.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "formats/dump_header.h"

namespace spool::format {

struct GroupLayout {
  uint32_t first_channel = 0;  // in DumpHeader::channels
  uint32_t channel_count = 0;
  DataType type = DataType::kFloat32;
  Scope scope = Scope::kSample;
  uint32_t tiles = 0;   // 1 for scope pass
  uint32_t blocks = 0;  // 1 for scope pixel
  uint32_t first_slot = 0;
};

class DumpGeometry {
 public:
  DumpGeometry() = default;
  // `header` must have passed check_dump_header (geometry_rules.h).
  explicit DumpGeometry(const DumpHeader& header);

  uint32_t tiles_x() const { return tiles_x_; }
  uint32_t tiles_y() const { return tiles_y_; }
  uint32_t blocks() const { return blocks_; }
  uint32_t slot_count() const { return slot_count_; }
  const std::vector<GroupLayout>& groups() const { return groups_; }

  PixelRect tile_rect(uint32_t tile) const;
  uint32_t block_begin(uint16_t group, uint32_t block) const;
  uint32_t block_count(uint16_t group, uint32_t block) const;
  // Decoded bytes of a block that exists.
  uint64_t raw_bytes(uint16_t group, uint32_t tile, uint32_t block) const;

  // nullopt when the geometry has no such block.
  std::optional<uint32_t> slot(uint16_t group, uint32_t tile, uint32_t block) const;
  std::optional<uint32_t> block_of(uint16_t group, uint32_t sample_begin) const;

 private:
  uint32_t width_ = 0, height_ = 0, tile_size_ = 1, spp_ = 0, block_spp_ = 1;
  uint32_t tiles_x_ = 0, tiles_y_ = 0, blocks_ = 0, slot_count_ = 0;
  std::vector<GroupLayout> groups_;
};

}  // namespace spool::format
